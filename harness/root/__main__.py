"""`python -m crosstrace` is the command `crosstrace`."""

from crosstrace.harness.cli import main

if __name__ == "__main__":
    main()
