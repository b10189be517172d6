"""Signals that ask to end: raised once, and given back afterwards."""

import os
import signal
from threading import Thread

import pytest

from sim.signals import EndedBySignal, raise_on_signals


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
