"""``python -m derive``: the same as ``holonomic derive``."""

import sys

from derive.commands.regenerate import main

sys.exit(main(sys.argv[1:]))
