"""The coils' own field: taken off where it is certain what a sample shows, else the sample is blanked."""

import numpy as np
import pytest
from gate_samples import measured

from fsw.core.actuation.actuator import CoilView
from fsw.core.actuation.own_field import OwnField, subtract_own_field
from fsw.core.estimation.samples import usable_field
from fsw.wire.messages import CoilStatus, MagField

F = ((2000.0, -300.0, 100.0), (50.0, 1500.0, -700.0), (-900.0, 200.0, 2500.0))
LEVELS = (0.5, 2.0, 8.0)
CURRENTS = (25.0, 100.0, 400.0)
EARTH = (21000.0, -8000.0, 33000.0)
OFF = (0, 0, 0)


def own_field(newest, oldest):
    return OwnField(F, newest, oldest, LEVELS, CURRENTS)


def fly(driven, config, late=0):
    """(usable field in nT or None) by tick, of a sensor that shows what was driven ``late`` ticks before.

    ``driven``: by tick (coil, level, current), None: no report.
    """
    view, found = CoilView(), []
    for k, (_coil, _level, _) in enumerate(one or OFF for one in driven):
        shown_coil, shown_level, _ = (driven[k - late] or OFF) if k >= late else OFF
        m = np.zeros(3)
        m[shown_coil] = np.sign(shown_level) * (0.0, *LEVELS)[abs(shown_level)]
        field = np.array(EARTH) + np.array(F) @ m
        report = driven[k]
        status = None if report is None else CoilStatus(report[1], report[0], 0, report[2], 0, 1)
        readings = measured(field=MagField(1, *field.tolist()), coil=status)
        coil, level, _ = report or OFF
        view.driven_coil, view.driven_level = coil, level
        subtract_own_field(view, readings, 0, config)
        sample = usable_field(readings)
        found.append(None if sample is None else tuple(1e9 * part for part in sample))
    return found


ON = (1, -3, -400)
PULSE = [OFF, OFF, OFF, OFF, ON, ON, ON, OFF, OFF, OFF, OFF]


def used(found):
    return [k for k, sample in enumerate(found) if sample is not None]


def test_at_once_every_sample_is_used_and_shows_the_earth_alone():
    found = fly(PULSE, own_field(0, 0))
    assert used(found) == list(range(len(PULSE)))
    assert all(sample == pytest.approx(EARTH, rel=1e-12) for sample in found)


def test_two_ticks_late_the_pulse_is_subtract_own_field_two_ticks_later():
    found = fly(PULSE, own_field(2, 2), late=2)
    assert used(found) == list(range(2, len(PULSE)))
    assert all(found[k] == pytest.approx(EARTH, rel=1e-12) for k in used(found))


def test_between_two_ticks_the_edges_are_blanked():
    """A sample of 1 to 2 ticks before may show either of two dipoles."""
    found = fly(PULSE, own_field(1, 2))
    assert set(used(found)) == set(range(2, len(PULSE))) - {5, 8}


def test_a_wrong_delay_shows_so_the_test_can_fail():
    found = fly(PULSE, own_field(0, 0), late=1)
    assert found[4] != pytest.approx(EARTH, rel=1e-3)


@pytest.mark.parametrize("doubtful", [None, (1, -3, 400), (1, -3, -200), (1, -3, 0), (0, 0, 30)], ids=str)
def test_what_is_not_certain_blanks_until_it_can_show_no_more(doubtful):
    """No report, a current that is not the level's, one without a level."""
    driven = [*[OFF] * 5, doubtful, *[OFF] * 5]
    assert used(fly(driven, own_field(1, 2))) == [2, 3, 4, 8, 9, 10]


def test_without_the_field_a_pulse_is_blanked_as_long_as_a_sample_may_be_old():
    for blank_ticks, used in ((2, True), (3, False)):
        readings = measured(field=MagField(1, *EARTH), coil=CoilStatus(0, 0, 0, 0, 0, 1))
        view = CoilView(idle_ticks=3)
        subtract_own_field(view, readings, blank_ticks, None)
        assert view == CoilView(idle_ticks=3)
        assert (usable_field(readings) is not None) is used
