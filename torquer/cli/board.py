"""``torquer board``: a board by hand, with the options of ``python -m hil_stub``."""

from hil_stub.process.command import board

__all__ = ["board"]
