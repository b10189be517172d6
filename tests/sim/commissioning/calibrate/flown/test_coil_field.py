"""Response of the channels to the coils, and how late it shows."""

from dataclasses import replace

import numpy as np
import pytest

from sim.commissioning.calibrate.flown.coil_field import coil_response

RESPONSE = np.array([[1800.0, -300.0, 90.0], [-700.0, 40.0, 2500.0], [250.0, -1900.0, -600.0]])
LEVELS = (0.5, 2.0, 8.0)


@pytest.mark.parametrize("delay", [0.0, 0.3, 1.0, 1.46, 2.0])
def test_response_and_delay_are_found_in_a_field_that_turns(pulsed, delay):
    found = coil_response(pulsed(RESPONSE, delay), LEVELS)
    assert found.nt_per_am2 == pytest.approx(RESPONSE, abs=3.0)
    assert found.delay_ticks == pytest.approx(delay, abs=0.011)
    assert found.pulses == (2, 2, 2)


@pytest.mark.long
@pytest.mark.parametrize(("tick_hz", "delay_s"), [(4, 2.0), (10, 0.66), (10, 3.0), (40, 0.55)])
def test_so_are_they_with_many_ticks_a_second(pulsed, tick_hz, delay_s):
    found = coil_response(pulsed(RESPONSE, delay_s * tick_hz, noise_nt=100.0, tick_hz=tick_hz), LEVELS)
    assert found.nt_per_am2 == pytest.approx(RESPONSE, abs=5.0 * found.sigma.max())
    assert found.sigma.max() < 10.0
    assert abs(found.delay_ticks - delay_s * tick_hz) < 4.0 * found.delay_sigma
    assert found.delay_sigma < 0.02 * tick_hz
    assert found.pulses == (2, 2, 2)


def test_short_pauses_leave_room_for_short_delays(pulsed):
    """Pulses of 3 s with 4 s between them: up to 2 s late."""
    found = coil_response(pulsed(RESPONSE, 12.0, noise_nt=100.0, every=7, tick_hz=10), LEVELS)
    assert found.pulses == (2, 2, 2)
    assert found.nt_per_am2 == pytest.approx(RESPONSE, abs=5.0 * found.sigma.max())
    assert abs(found.delay_ticks - 12.0) < 4.0 * found.delay_sigma
    late = coil_response(pulsed(RESPONSE, 25.0, noise_nt=100.0, every=7, tick_hz=10), LEVELS)
    assert late.delay_ticks is None


@pytest.mark.parametrize("delay", [4.0, 4.5, 5.5])
def test_a_delay_beyond_what_is_looked_for_is_not_told(pulsed, delay):
    found = coil_response(pulsed(RESPONSE, delay), LEVELS)
    assert (found.delay_ticks, found.delay_sigma) == (None, None)


@pytest.mark.long
def test_errors_are_as_large_as_it_says(pulsed):
    found = coil_response(pulsed(RESPONSE, 1.46, noise_nt=200.0, pulses=18), LEVELS)
    off = (found.nt_per_am2 - RESPONSE) / found.sigma
    assert np.abs(off).max() < 4.0
    assert 0.5 < np.sqrt(np.mean(off**2)) < 1.6
    assert abs(found.delay_ticks - 1.46) < 3.0 * found.delay_sigma
    assert found.noise_nt == pytest.approx(200.0, rel=0.1)


def test_where_nothing_shows_there_is_no_delay(pulsed):
    found = coil_response(pulsed(0.0 * RESPONSE, 1.0, noise_nt=200.0), LEVELS)
    assert found.delay_ticks is None
    assert np.abs(found.nt_per_am2).max() < 5.0 * found.sigma.max()


def test_pulses_of_two_coils_without_a_pause_between_them_tell_nothing_of_either(pulsed):
    """Each coil with a back-off of its own: the next is driven as soon as the one before has ended."""
    samples = pulsed(RESPONSE, 0.0)
    coil, level, field_nt = samples.coil.copy(), samples.level.copy(), samples.field_nt.copy()
    for begin in (20, 60, 100):  # of the first three pulses, of 3 ticks each
        after = slice(begin + 3, begin + 6)
        coil[after], level[after] = (coil[begin] + 1) % 3, 3
        field_nt[after] += LEVELS[2] * RESPONSE[:, coil[after][0]]
    found = coil_response(replace(samples, coil=coil, level=level, field_nt=field_nt), LEVELS)
    assert found.nt_per_am2 == pytest.approx(RESPONSE, abs=3.0)
    assert found.pulses == (1, 1, 1)


@pytest.mark.long
def test_a_pulse_whose_report_was_lost_is_not_taken_for_none(pulsed):
    """Nor does it shorten the delays that are looked for, or spoil the pulses beside it."""
    samples = pulsed(RESPONSE, 2.0, pulses=12, every=20)
    level, reported = samples.level.copy(), samples.reported.copy()
    driven = np.flatnonzero(level)
    lost = driven[[1, 9, 10, 11]]  # the middle of the first pulse, and the fourth
    level[lost], reported[lost] = 0, False
    lossy = replace(samples, level=level, reported=reported)
    whole, found = coil_response(samples, LEVELS), coil_response(lossy, LEVELS)
    assert found.nt_per_am2 == pytest.approx(RESPONSE, abs=0.1)
    assert found.delay_ticks == pytest.approx(2.0, abs=0.1)
    assert sum(found.pulses) == sum(whole.pulses) - 2


def test_an_output_that_was_not_fired_is_not_known(pulsed):
    found = coil_response(pulsed(RESPONSE, 0.0, pulses=2), LEVELS)
    assert found.pulses == (1, 1, 0)
    assert np.isinf(found.sigma[:, 2]).all() or found.sigma[:, 2].min() > 1e6


def test_a_pulse_at_the_edge_of_the_log_is_left_out(pulsed):
    samples = pulsed(RESPONSE, 0.0)
    cut = slice(0, 226)  # the last pulse begins at 220
    parts = [getattr(samples, name)[cut] for name in samples.__slots__]
    assert coil_response(type(samples)(*parts), LEVELS).pulses == (2, 2, 1)
