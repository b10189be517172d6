"""Which samples the filter may use: none that a coil may have spoilt."""

import pytest

from fsw.core.estimation.samples import coils_idle, usable_field, usable_sun
from fsw.core.gate.readings import NOTHING
from fsw.wire.messages import CoilStatus, MagField, SunVector

IDLE = CoilStatus(0, 2, 0, 0, 98000, 0)
FIELD, SUN = MagField(1, 17000.0, -23000.0, 31000.0), SunVector(1, 0.6, -0.48, 0.64)


def readings_with(**changes):
    """What all boards send while no coil is driven, with changes."""
    return NOTHING._replace(field=FIELD, sun=SUN, coil=IDLE)._replace(**changes)


def test_a_quiet_sample_is_taken_in_tesla():
    readings = readings_with(field=MagField(1, 20000.0, -7000.0, 31000.0))
    assert usable_field(readings) == pytest.approx((2.0e-5, -7.0e-6, 3.1e-5), rel=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"field": None},
        {"field": MagField(0, 20000.0, -7000.0, 31000.0)},
        {"coil": None},
        {"coil": IDLE._replace(level=1)},
        {"coil": IDLE._replace(level=-3)},
        {"coil": IDLE._replace(current_ma=1)},
        {"coil": IDLE._replace(current_ma=-1)},
        {"quiet": False},
    ],
    ids=[
        "none",
        "not valid",
        "no coil status",
        "driven",
        "driven backwards",
        "current",
        "current backwards",
        "a pulse not long ago",
    ],
)
def test_a_sample_that_a_coil_may_have_spoilt_is_not(changes):
    assert usable_field(readings_with(**changes)) is None


def test_what_remains_of_a_pulse_does_not_count_before_it_is_driven():
    """Level is what was driven until now; the sample is good if nothing was."""
    assert usable_field(readings_with(coil=IDLE._replace(remaining_ms=3000))) is not None


def test_coils_are_idle_while_and_since_none_is_driven():
    """Also where there is no sample, or none that is valid."""
    assert coils_idle(readings_with(field=None))
    assert not coils_idle(readings_with(coil=None))
    assert not coils_idle(readings_with(coil=IDLE._replace(level=-2)))
    assert not coils_idle(readings_with(quiet=False))


def test_a_pulse_not_long_ago_spoils_no_sun():
    assert usable_sun(readings_with(quiet=False)) is not None


def test_sun():
    assert usable_sun(readings_with(sun=SunVector(1, 0.6, -0.48, 0.64))) == (0.6, -0.48, 0.64)
    assert usable_sun(readings_with(sun=SunVector(0, 0.6, -0.48, 0.64))) is None
    assert usable_sun(readings_with(sun=None)) is None
