"""``torquer board``: a board alone, with the options of ``python -m hil_stub``."""

from hil_stub.process.command import board

__all__ = ["board"]
