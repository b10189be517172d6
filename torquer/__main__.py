"""``python -m torquer``: the ``torquer`` command, whatever packages the current directory holds."""

import os
import sys
from contextlib import suppress
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1]

with suppress(FileNotFoundError):  # the folder that this runs in is gone: there is nothing in it
    if sys.path[0] == os.getcwd() and Path.cwd() != PROJECT:
        del sys.path[0]

from torquer.cli.main import main  # noqa: E402  found without the current directory

main(prog_name="torquer")
