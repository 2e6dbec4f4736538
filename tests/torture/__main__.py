"""Run the attacks, print and write their counts; see docs/torture.md."""

import sys

from .command import main

sys.exit(main())
