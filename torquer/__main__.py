"""``python -m torquer``: the ``torquer`` command, whatever packages the current directory holds."""

import os
import sys
from pathlib import Path

HOUSE = Path(__file__).resolve().parents[1]

if sys.path[0] == os.getcwd() and Path.cwd() != HOUSE:
    del sys.path[0]

from torquer.cli.main import main  # noqa: E402  found without the current directory

main(prog_name="torquer")
