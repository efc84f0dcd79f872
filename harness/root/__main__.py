"""`python -m crosstrace` is the command `crosstrace`."""

import sys

from crosstrace.harness.cli import main

sys.exit(main())
