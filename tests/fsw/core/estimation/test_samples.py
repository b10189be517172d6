"""Which samples the filter may use: none that a coil may have spoilt."""

import pytest
from gate_samples import measured

from fsw.core.estimation.cells.cell_set import CellSet
from fsw.core.estimation.samples import coils_idle, sun_direction, usable_field, usable_sun
from fsw.wire.messages import CoilStatus, MagField, SunCells, SunVector

IDLE = CoilStatus(0, 2, 0, 0, 98000, 0)
FIELD, SUN = MagField(1, 17000.0, -23000.0, 31000.0), SunVector(1, 0.6, -0.48, 0.64)


def readings_with(**changes):
    """What all boards send while no coil is driven, with changes."""
    return measured(**({"field": FIELD, "sun": SUN, "coil": IDLE} | changes))


def test_a_quiet_sample_is_taken_in_tesla():
    readings = readings_with(field=MagField(1, 20000.0, -7000.0, 31000.0))
    assert usable_field(readings) == pytest.approx((2.0e-5, -7.0e-6, 3.1e-5), rel=1e-12)


@pytest.mark.parametrize(
    "changes",
    [
        {"field": None},
        {"field": MagField(0, 20000.0, -7000.0, 31000.0)},
        {"coil": None},
        {"coil": IDLE.replace(level=1)},
        {"coil": IDLE.replace(level=-3)},
        {"coil": IDLE.replace(current_ma=1)},
        {"coil": IDLE.replace(current_ma=-1)},
        {"quiet": False},
        {"field_trusted": False},
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
        "not trusted",
    ],
)
def test_a_sample_that_a_coil_may_have_spoilt_is_not(changes):
    assert usable_field(readings_with(**changes)) is None


def test_what_remains_of_a_pulse_does_not_count_before_it_is_driven():
    """Level is what was driven until now; the sample is good if nothing was."""
    assert usable_field(readings_with(coil=IDLE.replace(remaining_ms=3000))) is not None


def test_coils_are_idle_while_and_since_none_is_driven():
    """Also where there is no sample, or none that is valid."""
    assert coils_idle(readings_with(field=None))
    assert not coils_idle(readings_with(coil=None))
    assert not coils_idle(readings_with(coil=IDLE.replace(level=-2)))
    assert not coils_idle(readings_with(quiet=False))


def test_a_pulse_not_long_ago_spoils_no_sun():
    assert usable_sun(readings_with(quiet=False)) is not None


def test_sun():
    assert usable_sun(readings_with(sun=SunVector(1, 0.6, -0.48, 0.64))) == (0.6, -0.48, 0.64)
    assert usable_sun(readings_with(sun=SunVector(0, 0.6, -0.48, 0.64))) is None
    assert usable_sun(readings_with(sun=None)) is None
    assert usable_sun(readings_with(sun_trusted=False)) is None
    assert usable_sun(readings_with(field_trusted=False)) is not None


class TestSunDirection:
    """Three cells, one along each axis, the second of half the current."""

    CELLS = CellSet(
        normals_body=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        full_sun=(1.0, 0.5, 1.0),
        shades=((), (), ()),
        dark=0.05,
        sigma=0.01,
        excess_sigma=0.1,
        gain_sigma=0.05,
        light_sigma=0.1,
        albedo=0.3,
    )
    LIT = SunCells(1, 0.6, 0.25, 0.7, 0.0, 0.0, 0.0)

    def test_that_of_the_sensor_is_as_it_was_measured(self):
        assert sun_direction(readings_with(), None) == (0.6, -0.48, 0.64)
        assert sun_direction(readings_with(sun=None), None) is None

    def test_that_of_three_cells_has_unit_length(self):
        sun = sun_direction(readings_with(sun=None, cells=self.LIT), self.CELLS)
        assert sun == pytest.approx(tuple(c / 1.1**0.5 for c in (0.6, 0.5, 0.7)), rel=1e-12)

    def test_without_three_that_may_be_used_there_is_none(self):
        assert sun_direction(readings_with(cells=self.LIT, unusable_cells=(1,)), self.CELLS) is None
        assert sun_direction(readings_with(cells=self.LIT.replace(cell_1=0.0)), self.CELLS) is None
        assert sun_direction(readings_with(cells=None), self.CELLS) is None
        assert sun_direction(readings_with(cells=self.LIT, sun_trusted=False), self.CELLS) is None
