"""The ``torquer`` command, a file a command."""
