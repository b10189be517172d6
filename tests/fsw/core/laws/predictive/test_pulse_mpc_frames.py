"""What the search is told of a pulse fired now, of a body turned far: its effect in orbital axes."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.plan.pulse_model import NO_PULSE
from fsw.core.laws.predictive.pulse_mpc import pulse_mpc
from fsw.core.orbit.ephemeris import advance, reference_at
from fsw.table.config import flight_config
from fsw.table.table import flight_table

INERTIA = [[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]]
LEVELS_AM2, TICK = (0.5, 2.0, 8.0), 500
Q = normalise((0.7, -0.4, 0.5, 0.3))


def test_of_each_pulse_fired_now_it_is_the_change_of_rate_turned_back_from_the_body(monkeypatch):
    """J^-1 (T_p m x b) in body axes, by numpy."""
    sections = {"body": {"inertia_kgm2": INERTIA}, "coils": {"levels_am2": list(LEVELS_AM2)}}
    config = flight_config(flight_table(sections | {"control": {"law": "pulse_mpc"}}, "test"))
    model, seen = config.ephemeris, []
    reference = reference_at(advance(None, TICK, model), TICK, model)
    b_body_t = rotate(Q, rotate(reference.q_orbit_from_eci, reference.b_eci_t))
    sample = FieldSample(b_body_t, TICK)
    inputs = LawInput(Attitude(Q, (1e-4, -2e-4, 3e-4), 1e-3, 1e-6, True), b_body_t, sample, sample)
    inputs = inputs._replace(reference=reference, tick=TICK, ephemeris=model, wait_ticks=(0, 0, 0))
    monkeypatch.setattr(
        "fsw.core.laws.predictive.pulse_mpc.first_pulse",
        lambda state, ahead, *rest: seen.extend(ahead) or NO_PULSE,
    )
    pulse_mpc(inputs, (), config.control.setpoint, config.control)
    for (coil, level), kick in zip(config.control.pulse_model.pulses, seen[0].kicks, strict=True):
        m = np.eye(3)[coil] * np.sign(level) * (0.0, *LEVELS_AM2)[abs(level)]
        expected = np.linalg.solve(INERTIA, config.control.horizon_s * np.cross(m, b_body_t))
        assert rotate(Q, tuple(kick.tolist())) == pytest.approx(expected, rel=1e-6, abs=1e-14)
