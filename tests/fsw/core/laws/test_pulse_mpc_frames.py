"""What the search is told of a pulse fired now, of a body turned far: its effect in orbital axes."""

import numpy as np
import pytest

from fsw.core.algebra.quaternion import normalise, rotate
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.lqr import latitude_argument, node
from fsw.core.laws.plan.pulse_model import NO_PULSE
from fsw.core.laws.pulse_mpc import pulse_mpc
from fsw.core.orbit.ephemeris import advance, reference_at
from fsw.table.config import flight_config
from fsw.table.table import flight_table

INERTIA = [[1.02, 0.13, -0.09], [0.13, 1.85, 0.21], [-0.09, 0.21, 1.95]]
LEVELS_AM2, TICK = (0.5, 2.0, 8.0), 500
Q = normalise((0.7, -0.4, 0.5, 0.3))
SECTIONS = {"body": {"inertia_kgm2": INERTIA}, "coils": {"levels_am2": list(LEVELS_AM2)}}


@pytest.fixture
def told(monkeypatch):
    """What the search is told at a tick, and of what configuration and inputs."""

    def at(tick, sections):
        config = flight_config(flight_table(sections | {"control": {"law": "pulse_mpc"}}, "test"))
        model, seen = config.ephemeris, []
        reference = reference_at(advance(None, tick, model), tick, model)
        b_body_t = rotate(Q, rotate(reference.q_orbit_from_eci, reference.b_eci_t))
        sample = FieldSample(b_body_t, tick)
        inputs = LawInput(Attitude(Q, (1e-4, -2e-4, 3e-4), 1e-3, 1e-6, True), b_body_t, sample, sample)
        inputs = inputs.replace(reference=reference, tick=tick, ephemeris=model, wait_ticks=(0, 0, 0))
        monkeypatch.setattr(
            "fsw.core.laws.pulse_mpc.first_pulse",
            lambda state, ahead, *rest: seen.extend(ahead) or NO_PULSE,
        )
        pulse_mpc(inputs, (), config.control.setpoint, config.control)
        return config.control, inputs, seen

    return at


@pytest.mark.interpreted
def test_of_each_pulse_fired_now_it_is_the_change_of_rate_turned_back_from_the_body(told):
    """J^-1 (T_p m x b) in body axes, by numpy."""
    control, inputs, seen = told(TICK, SECTIONS)
    for pulse, kick in zip(control.pulse_model.pulses, seen[0].kicks, strict=True):
        coil, level = pulse.values()
        m = np.eye(3)[coil] * np.sign(level) * (0.0, *LEVELS_AM2)[abs(level)]
        expected = np.linalg.solve(INERTIA, control.horizon_s * np.cross(m, inputs.b_body_t))
        assert rotate(Q, tuple(kick.tolist())) == pytest.approx(expected, rel=1e-6, abs=1e-14)


@pytest.mark.interpreted
@pytest.mark.parametrize("tick", [500, 5000, 20000])
def test_what_is_left_after_the_last_of_them_is_the_regulators_cost_over_the_same_time(told, tick):
    """In the direct dipole's field.

    The steps of the regulator are longer than the time between opportunities. Of the pitch, on whose cost the
    place in the orbit hardly counts.
    """
    control, inputs, seen = told(tick, SECTIONS | {"field": {"model": "direct_dipole"}})
    pulses, table = control.pulse_model, control.schedules["pulse_mpc"]
    ahead_rad = inputs.reference.orbit_rate_radps * pulses.searched * pulses.problem.step_s
    expected = table.costs[node(latitude_argument(inputs.reference) + ahead_rad)] * table.problem.step_s
    found = seen[-1].cost * pulses.problem.step_s
    assert table.problem.step_s > 1.1 * pulses.problem.step_s
    for pitch in (2, 5):
        assert found[pitch, pitch] == pytest.approx(expected[pitch, pitch], rel=0.03)
