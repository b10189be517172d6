"""``python -m torquer``: the ``torquer`` command."""

from torquer.cli.main import main

main(prog_name="torquer")
