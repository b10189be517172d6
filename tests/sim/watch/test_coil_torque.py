"""What the coils do: sizes where the satellite is known, else directions; nothing where none is driven."""

import pytest

from fsw.core.algebra.vector import dot
from fsw.wire.messages import CoilStatus, MagField, Sync
from sim.scenario.schema import load
from sim.watch.coil_torque import coil_torque, craft_of
from sim.watch.flight_view import FlightView
from sim.watch.snapshot import snapshot

FIELD_T = (1e-5, -2e-5, 3e-5)
CRAFT = craft_of(load("microsat"))
CONTINUOUS = craft_of(load("microsat", {"coils": {"driver": "continuous", "max_dipole_am2": 4.0}}))


def test_a_level_is_the_dipole_of_the_scenario_with_the_sign_of_the_level():
    found = coil_torque((0, -3, 0), None, FIELD_T, CRAFT)
    assert found.in_units
    assert found.dipole == (0.0, -CRAFT.levels_am2[2], 0.0)


def test_the_torque_is_dipole_cross_field():
    found = coil_torque((0, 0, 1), None, FIELD_T, CRAFT)
    m = CRAFT.levels_am2[0]
    assert found.torque == pytest.approx((-m * FIELD_T[1], m * FIELD_T[0], 0.0))
    assert dot(found.torque, FIELD_T) == pytest.approx(0.0, abs=1e-20)


def test_a_continuous_driver_drives_parts_of_its_full_dipole():
    found = coil_torque((0, 0, 0), (0.5, 0.0, -1.0), FIELD_T, CONTINUOUS)
    assert found.dipole == (2.0, 0.0, -4.0)


def test_without_the_satellite_there_are_directions_and_no_sizes():
    found = coil_torque((2, 0, 0), None, FIELD_T, None)
    assert not found.in_units
    assert found.dipole == (2.0, 0.0, 0.0)


@pytest.mark.parametrize("fractions", [None, (0.0, 0.0, 0.0)])
def test_no_coil_driven_is_no_dipole(fractions):
    assert coil_torque((0, 0, 0), fractions, FIELD_T, CRAFT) is None


def test_without_a_field_there_is_a_dipole_and_no_torque():
    assert coil_torque((1, 0, 0), None, None, CRAFT).torque is None


def test_a_reading_that_a_coil_disturbs_is_not_the_field_of_the_torque():
    view = FlightView(craft=CRAFT)
    for frame in (
        MagField(1, 10000.0, 0.0, 0.0, 0),
        Sync(0, 1427424417),
        CoilStatus(3, 2, 2000, 100, 100_000, 1, 1),
        MagField(1, 0.0, 90000.0, 0.0, 1),
    ):
        view.take(frame.encode(), 0.0)
    found = view.coil_torque()
    m = CRAFT.levels_am2[2]
    assert found.torque == pytest.approx((0.0, m * 1e-5, 0.0))
    body = snapshot(view, 0, 0)["body"]
    assert (body["dipole"], body["torque"], body["in_units"]) == (found.dipole, found.torque, True)
    assert body["q"] is None
    assert {"dipole", "torque"} <= view.arrows().keys()


def test_a_pulse_that_is_over_is_remembered_as_the_last():
    view = FlightView(craft=CRAFT)
    for level in (1, 0):
        for frame in (MagField(1, 10000.0, 0.0, 0.0, 0), CoilStatus(level, 2, 0, 100, 100_000, 1, 1)):
            view.take(frame.encode(), 0.0)
    body = snapshot(view, 0, 0)["body"]
    assert view.coil_torque() is None
    assert (body["driving"], body["dipole"]) == (False, (0.0, 0.0, CRAFT.levels_am2[0]))
