"""``python -m gaitforge``."""

import sys

from gaitforge.cli import main

sys.exit(main())
