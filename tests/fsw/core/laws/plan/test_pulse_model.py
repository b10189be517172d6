"""What a pulse can be, and what each does to the rate of a body in a field."""

import numpy as np
import pytest

from fsw.core.algebra.vector import inverse
from fsw.core.laws.plan.orbit_ahead import Sight
from fsw.core.laws.plan.pulse_model import AXES, NEVER, NO_PULSE, Pulse, PulseModel, choices, kicks
from fsw.core.laws.plan.riccati import regulator_problem

INERTIA = ((1.02, 0.03, -0.05), (0.03, 1.85, 0.02), (-0.05, 0.02, 1.95))
LEVELS_AM2, PULSE_S = (0.5, 2.0, 8.0), 3.0
TURNED = ((0.98, 0.05, -0.02), (0.01, 1.03, 0.04), (-0.03, 0.02, 0.97))
"""Rows: the dipole of a nominal 1 A m^2 of each coil."""
FIELD_T = np.array([2.1e-5, -1.3e-5, 0.9e-5])


def model_of(axes=AXES):
    pulses, turns = choices(LEVELS_AM2, PULSE_S, inverse(INERTIA), axes)
    problem = regulator_problem(INERTIA, (0.0, 0.0, 0.0), 1.04e-3, 3e-5, 103.0, 1e-3, 1.0)
    return PulseModel(pulses, turns, 103, 1, problem, 6, Sight((), np.zeros((0, 0))))


def test_there_are_eighteen_and_none():
    pulses = model_of().pulses
    assert pulses[0] == NO_PULSE
    assert sorted(pulses[1:], key=Pulse.values) == [
        Pulse(coil, level) for coil in range(3) for level in (-3, -2, -1, 1, 2, 3)
    ]
    assert [pulse.coil for pulse in pulses[1:]] == [0] * 6 + [1] * 6 + [2] * 6, "coil by coil"


@pytest.mark.parametrize("axes", [AXES, TURNED])
def test_each_changes_the_rate_by_its_impulse_across_the_field(axes):
    """J^-1 (T_p m x b)."""
    model = model_of(axes)
    for pulse, kick in zip(model.pulses, kicks(model, FIELD_T), strict=True):
        level = abs(pulse.level)
        size = 0.0 if level == 0 else np.sign(pulse.level) * LEVELS_AM2[level - 1]
        impulse = PULSE_S * np.cross(size * np.array(axes[pulse.coil]), FIELD_T)
        assert kick == pytest.approx(np.linalg.solve(INERTIA, impulse), rel=1e-9, abs=1e-15)


def test_in_many_fields_at_once():
    model, fields = model_of(), np.random.default_rng(3).normal(size=(4, 5, 3)) * 3e-5
    found = kicks(model, fields)
    assert found.shape == (4, 5, 19, 3)
    assert np.array_equal(found[2, 3], kicks(model, fields[2, 3]))


def test_never_is_no_number_of_ticks():
    assert NEVER < 0
