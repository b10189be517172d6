"""SIGTERM and SIGHUP as an exception, so that a process closes its files and ends its nodes first."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread, current_thread, main_thread
from types import CodeType, FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_NAMES = ("SIGTERM", "SIGHUP")  # not everywhere are both
AGAIN_S = 0.01
"""After which a signal whose exception was dropped is sent again."""


class EndedBySignal(BaseException):
    """A signal asks this process to end.

    Attributes:
        signum: the signal.
        exit_code: of the process: 128 plus the number of the signal.
    """

    def __init__(self, signum: int) -> None:
        super().__init__(f"ended by {signal.Signals(signum).name}; what was written so far is kept")
        self.signum = signum
        self.exit_code = 128 + signum


@contextmanager
def raise_on_signals() -> Iterator[None]:
    """Raise ``EndedBySignal`` at the first of these signals, and ignore more of them while it is handled.

    A signal that was ignored before (``nohup``) stays so. Python drops an exception that is raised in a
    finaliser or in the callback of a weak reference: this one, and that of Ctrl-C, are raised again after it.
    """
    if current_thread() is not main_thread():
        yield
        return
    signums = [getattr(signal, name) for name in _NAMES if hasattr(signal, name)]
    handlers = {signum: signal.getsignal(signum) for signum in signums}
    mine = [signum for signum, handler in handlers.items() if handler is not signal.SIG_IGN]
    hook, over, senders = sys.unraisablehook, Event(), list[Thread]()

    def end(signum: int, frame: FrameType | None) -> None:
        for each in mine:
            signal.signal(each, signal.SIG_IGN)
        raise EndedBySignal(signum)

    def raise_again(dropped: "UnraisableHookArgs") -> None:
        if isinstance(dropped.exc_value, EndedBySignal):
            listen()
            send_again(dropped.exc_value.signum)
        elif isinstance(dropped.exc_value, KeyboardInterrupt):
            send_again(signal.SIGINT)
        else:
            hook(dropped)

    def send_again(signum: int) -> None:
        sender = Thread(target=_send, args=(signum, raise_again.__code__, over), daemon=True)
        senders.append(sender)
        sender.start()

    def listen() -> None:
        for signum in mine:
            signal.signal(signum, end)

    listen()
    sys.unraisablehook = raise_again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        over.set()
        try:
            for sender in senders:
                sender.join()
        finally:
            for signum in mine:
                signal.signal(signum, handlers[signum])


def _send(signum: int, hook: CodeType, over: Event) -> None:
    """Send this process the signal once its main thread has left ``hook``, where it would be lost."""
    while not over.wait(AGAIN_S):
        frame = sys._current_frames().get(main_thread().ident or 0)
        while frame is not None and frame.f_code is not hook:
            frame = frame.f_back
        if frame is None:
            os.kill(os.getpid(), signum)
            return
