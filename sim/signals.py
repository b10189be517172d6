"""SIGTERM and SIGHUP as an exception, so that a process closes its files and ends its nodes first."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from threading import current_thread, main_thread
from types import FrameType

_NAMES = ("SIGTERM", "SIGHUP")  # not everywhere are both


class EndedBySignal(BaseException):
    """A signal asks this process to end.

    Attributes:
        exit_code: of the process: 128 plus the number of the signal.
    """

    def __init__(self, signum: int) -> None:
        super().__init__(f"ended by {signal.Signals(signum).name}; what was written so far is kept")
        self.exit_code = 128 + signum


@contextmanager
def raise_on_signals() -> Iterator[None]:
    """Raise ``EndedBySignal`` at the first of these signals, and ignore more of them while it is handled.

    A signal that was ignored before (``nohup``) stays so.
    """
    if current_thread() is not main_thread():
        yield
        return
    signums = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    handlers = {signum: signal.getsignal(signum) for signum in signums}
    mine = [signum for signum, handler in handlers.items() if handler is not signal.SIG_IGN]

    def end(signum: int, frame: FrameType | None) -> None:
        for each in mine:
            signal.signal(each, signal.SIG_IGN)
        raise EndedBySignal(signum)

    for signum in mine:
        signal.signal(signum, end)
    try:
        yield
    finally:
        for signum in mine:
            signal.signal(signum, handlers[signum])
