"""Torquer for programs: each function does what the command of its name does; ``fly`` is ``torquer sil``."""
