"""The second audit: of the currents that flowed."""

from fractions import Fraction

import pytest

from sim.fault_rig.currents import CurrentLimits, CurrentPulse, pulses, violations
from sim.plant.coil_drive import CoilDrive

OFF = CoilDrive((0.0, 0.0, 0.0), 0.0)
LEVELS_A = (0.025, 0.1, 0.4)


def on(coil, current_a=0.1, fraction=1.0):
    return CoilDrive(tuple(current_a if each == coil else 0.0 for each in range(3)), fraction)


def limits(tick_hz=1, shared=True):
    return CurrentLimits(tick_hz, LEVELS_A, Fraction(3), Fraction(100), shared)


def test_pulses_at_the_limits_are_kept():
    drives = [on(0)] * 3 + [OFF] * 100 + [on(1, -0.4)] * 3 + [OFF]
    assert violations(drives, limits()) == []
    assert pulses(drives, 1) == [CurrentPulse(0, Fraction(0), Fraction(3)), CurrentPulse(1, 103, 106)]


@pytest.mark.parametrize(
    ("drives", "said"),
    [
        ([on(0)] * 3 + [on(0, fraction=0.001)], "coil 0 on for 3.001 s"),
        ([on(2)] * 4, "coil 2 on for 4 s"),
        ([on(0)] + [OFF] * 99 + [on(1)], "coil 1 on 99 s after a pulse"),
        ([on(0)] * 2 + [on(1)] + [OFF], "coil 1 on 0 s after a pulse"),
        ([CoilDrive((0.1, 0.1, 0.0), 1.0), OFF], "2 coils at once"),
        ([on(0, 0.2), OFF], "0.2 A is no level"),
        ([on(0, 0.1 * (1.0 + 1e-6)), OFF], "is no level"),
    ],
)
def test_each_breach_is_reported(drives, said):
    assert any(said in sentence for sentence in violations(drives, limits()))


def test_a_pulse_that_ends_within_a_tick_is_as_long_as_it_flowed():
    drives = [on(1)] * 29 + [on(1, fraction=0.9)] + [OFF] * 5
    assert pulses(drives, 10) == [CurrentPulse(1, Fraction(0), Fraction("2.99"))]


def test_a_coil_that_is_held_on_flows_for_the_whole_tick_beside_one_that_does_not():
    drive = CoilDrive((0.1, 0.4, 0.0), 0.5, (0.0, 0.4, 0.0))
    alone = CoilDrive((0.0, 0.4, 0.0), 0.0, (0.0, 0.4, 0.0))
    assert pulses([drive, alone, OFF], 1) == [CurrentPulse(0, 0, Fraction(1, 2)), CurrentPulse(1, 0, 2)]
    assert any("tick 0: 2 coils at once" in one for one in violations([drive, alone, OFF], limits()))


def test_a_back_off_of_its_own_holds_between_pulses_of_one_coil_alone():
    drives = [on(0)] * 3 + [OFF] * 2 + [on(1)] * 3 + [OFF] * 2 + [on(0)]
    assert [one for one in violations(drives, limits(shared=False)) if "coil 1" in one] == []
    assert any("coil 0 on 7 s after" in one for one in violations(drives, limits(shared=False)))
