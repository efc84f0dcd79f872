"""`python -m crosstrace` is the console script."""

from crosstrace.harness.cli import main

main()
