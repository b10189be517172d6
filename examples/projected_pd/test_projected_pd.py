"""The law of this package: its equation, the limits of the coils, and a flight."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest
from hypothesis import given, settings

from fsw.core.algebra.vector import cross, dot
from fsw.table.config import flight_config
from sim.scenario.schema import flight_table, load
from sim.testing import audit_law, flights

FILE = Path(__file__).with_name("projected_pd.py")
LAW = f"{FILE}:projected_pd"
spec = spec_from_file_location("projected_pd", FILE)
law = module_from_spec(spec)
spec.loader.exec_module(law)


def test_the_torque_is_the_part_of_the_wanted_one_that_is_normal_to_the_field():
    b, wanted = (1e-5, -2e-5, 3e-5), (4e-6, 5e-6, -6e-6)
    torque = cross(law.projected_dipole(b, wanted), b)
    along = dot(wanted, b) / dot(b, b)
    assert torque == pytest.approx([w - along * x for w, x in zip(wanted, b, strict=True)], rel=1e-12)


@pytest.mark.parametrize("b", [(0.0, 0.0, 0.0), (1e-160, 0.0, 0.0)])
def test_without_a_field_it_asks_for_nothing(b):
    assert law.projected_dipole(b, (4e-6, 5e-6, -6e-6)) == (0.0, 0.0, 0.0)


CONTROL = flight_config(flight_table(load("microsat", {"control": {"law": LAW}}))).control


@settings(deadline=None, max_examples=10)
@given(flights())
def test_it_keeps_the_limits_of_the_coils(flight):
    assert audit_law(CONTROL.own.point, flight, CONTROL).ok


def test_it_points_the_satellite(fly):
    flight = fly("microsat", orbits=2, seed=2, law=LAW)
    flight.expect("pointing_deg.final < 10", "mode_final == POINT", "limits_ok == true")
    flight.expect("replay.bit_exact == true", "duty.total < 0.03")
    assert flight.audit().ok
