"""Signals that ask to end: raised once, and given back afterwards."""

import os
import signal
import sys
import time
import weakref
from threading import Thread

import pytest

from sim.signals import EndedBySignal, raise_on_signals


@pytest.fixture(autouse=True)
def not_under_nohup():
    """A hangup that is ignored from the start stays so: as under nohup, where these tests may run."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize(("signum", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_the_first_is_raised_and_more_do_not_disturb_the_cleaning_up(signum, code):
    before = signal.getsignal(signum)
    cleaned = []

    def be_ended():
        try:
            os.kill(os.getpid(), signum)
        finally:
            os.kill(os.getpid(), signal.SIGTERM)
            os.kill(os.getpid(), signal.SIGHUP)
            cleaned.append(True)

    with pytest.raises(EndedBySignal) as caught, raise_on_signals():
        be_ended()
    assert cleaned
    assert caught.value.exit_code == code
    assert signal.Signals(signum).name in str(caught.value)
    assert signal.getsignal(signum) is before


class Ending:
    """What sends this process a signal when it goes, so that its exception is raised in a finaliser."""

    def __init__(self, signum):
        self.signum = signum

    def __del__(self):
        os.kill(os.getpid(), self.signum)


def by_finaliser(signum):
    Ending(signum)


def by_callback(signum):
    def referent():
        pass

    reference = weakref.ref(referent, lambda gone: os.kill(os.getpid(), signum))
    del referent
    assert reference() is None


@pytest.mark.parametrize("drop", [by_finaliser, by_callback])
@pytest.mark.parametrize(
    ("signum", "raised"),
    [
        (signal.SIGTERM, EndedBySignal),
        (signal.SIGHUP, EndedBySignal),
        (signal.SIGINT, KeyboardInterrupt),
    ],
)
def test_one_whose_exception_python_drops_is_raised_again(drop, signum, raised):
    def be_ended():
        drop(signum)
        time.sleep(5.0)

    with pytest.raises(raised), raise_on_signals():
        be_ended()


def test_it_is_raised_again_as_often_as_it_is_dropped():
    until_s = time.monotonic() + 5.0

    def be_ended():
        for _ in range(20):
            by_finaliser(signal.SIGTERM)
        while time.monotonic() < until_s:
            pass

    with pytest.raises(EndedBySignal), raise_on_signals():
        be_ended()
    time.sleep(0.05)  # none of them comes after it


def test_what_else_python_drops_is_told_as_before(monkeypatch):
    told = []
    monkeypatch.setattr(sys, "unraisablehook", told.append)

    class Failing:
        def __del__(self):
            raise ValueError("lost")

    with raise_on_signals():
        Failing()
    assert [str(one.exc_value) for one in told] == ["lost"]
    assert sys.unraisablehook == told.append


def test_one_that_is_ignored_stays_so():
    """As ``nohup`` wants it."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with raise_on_signals():
            os.kill(os.getpid(), signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


def test_elsewhere_than_in_the_main_thread_nothing_is_changed():
    before = signal.getsignal(signal.SIGTERM)
    found = []

    def look():
        with raise_on_signals():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = Thread(target=look)
    thread.start()
    thread.join()
    assert found == [before]
