"""A pause of this computer is seen, and told once."""

import time

import pytest

from sim.conformance import pauses
from sim.conformance.pauses import PauseWatch

pytestmark = pytest.mark.long


def test_a_thread_that_wakes_late_is_a_pause_which_is_told_once(monkeypatch):
    asleep = time.sleep
    monkeypatch.setattr(pauses.time, "sleep", lambda seconds: asleep(seconds + 0.3))
    with PauseWatch() as watch:
        asleep(0.5)
        assert watch.take_longest_s() >= 0.3
        assert watch.take_longest_s() == 0.0


def test_what_was_not_entered_has_seen_nothing():
    assert PauseWatch().take_longest_s() == 0.0
