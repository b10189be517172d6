"""Optimal pulses: when they are asked for, and how closely they point with nothing unknown."""

from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
import pytest

from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.quaternion import rotate
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws import by_mode
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.lqr import STEPS, latitude_argument, node
from fsw.core.laws.plan.orbit_ahead import orbit_ahead
from fsw.core.laws.plan.pulse_model import NEVER, NO_PULSE, kicks
from fsw.core.laws.plan.riccati import free_step
from fsw.core.laws.pulse_mpc import REPORTED_TICKS, RETRY, PulseMpcGains, _costs, pulse_mpc
from fsw.core.orbit.ephemeris import advance, reference_at
from fsw.table.config import flight_config
from fsw.table.table import flight_table
from fsw.wire.messages import Mode

ZERO = (0.0, 0.0, 0.0)
READY = (0, 0, 0)
BODY = {"inertia_kgm2": [[1.02, 0.002, -0.001], [0.002, 1.85, 0.003], [-0.001, 0.003, 1.95]]}


def config_of(**sections):
    control = {"law": "pulse_mpc"} | sections.pop("control", {})
    values = {"body": BODY, "coils": {"levels_am2": [0.5, 2.0, 8.0]}, "control": control}
    return flight_config(flight_table(values | sections, "test"))


CONFIG = config_of()
BALANCED = config_of(body={"inertia_kgm2": [1.02, 1.85, 1.95]})
"""Without products of inertia no torque is on the nominal attitude."""
FAR_SIGHTED = config_of(control={"gains": {"pulse_mpc": {"horizon_orbits": 0.3}}})
PER_COIL = config_of(coils={"levels_am2": [0.5, 2.0, 8.0], "backoff": "per_coil"})


def inputs_at(tick, theta_rad, omega_radps=ZERO, waits=READY, config=CONFIG, torque_nm=ZERO, dipole_am2=ZERO):
    """A satellite turned by a small angle, all known."""
    model = config.ephemeris
    reference = reference_at(advance(None, tick, model), tick, model)
    half = 0.5 * np.asarray(theta_rad)
    q = (sqrt(1.0 - half @ half), *half.tolist())
    attitude = Attitude(q, rotate(q, tuple(omega_radps)), 1e-3, 1e-6, True)
    b_body_t = rotate(q, rotate(reference.q_orbit_from_eci, reference.b_eci_t))
    sample = FieldSample(b_body_t, tick)
    return LawInput(
        attitude, b_body_t, sample, sample, None, reference, torque_nm, dipole_am2, tick, model, waits
    )


def ask(inputs, memory=(), config=CONFIG):
    return pulse_mpc(inputs, memory, config.control.setpoint, config.control)


TURNED = (0.06, -0.04, 0.05)
STILL = (1e-9, -1e-9, 1e-9)


class TestWhen:
    def test_a_turned_body_gets_a_pulse_and_then_none_for_a_back_off(self):
        asked = ask(inputs_at(500, TURNED))
        assert asked.pulse.level
        assert asked.memory == (500.0 + 103.0,)
        for tick in (501, 550, 602):
            later = ask(inputs_at(tick, TURNED), asked.memory)
            assert later.pulse == NO_PULSE
            assert later.memory == asked.memory
        assert ask(inputs_at(603, TURNED), asked.memory).pulse.level

    def test_a_body_that_needs_none_is_looked_at_again_sooner(self):
        asked = ask(inputs_at(500, STILL, config=BALANCED), config=BALANCED)
        assert asked.pulse == NO_PULSE
        assert asked.memory == (500.0 + -(-103 // RETRY),)
        assert ask(inputs_at(512, TURNED), asked.memory).pulse == NO_PULSE
        assert ask(inputs_at(513, TURNED), asked.memory).pulse.level

    @pytest.mark.parametrize("waits", [(40, 40, 40), (1, 2, 3), (NEVER, NEVER, NEVER)])
    def test_none_is_asked_for_while_no_coil_may_be_fired(self, waits):
        asked = ask(inputs_at(500, TURNED, waits=waits))
        assert asked.pulse == NO_PULSE
        assert asked.memory == ()

    def test_the_others_reports_are_waited_for_but_not_for_ever(self):
        """A board that does not report one coil does not bar the others."""
        memory = ()
        for tick in range(500, 500 + REPORTED_TICKS):
            asked = ask(inputs_at(tick, TURNED, waits=(0, 0, 2)), memory)
            assert asked.pulse == NO_PULSE
            memory = asked.memory
        asked = ask(inputs_at(500 + REPORTED_TICKS, TURNED, waits=(0, 0, 2)), memory)
        assert asked.pulse.level
        assert asked.pulse.coil != 2

    def test_a_coil_that_rests_long_is_not_waited_for(self):
        waits = (50, 0, 90)
        found = {ask(inputs_at(tick, TURNED, waits=waits)).pulse for tick in range(0, 6000, 500)}
        assert {pulse.coil for pulse in found if pulse.level} == {1}

    @pytest.mark.parametrize("coil", range(3))
    def test_a_coil_with_a_fault_is_never_fired(self, coil):
        waits = tuple(NEVER if number == coil else 0 for number in range(3))
        found = {ask(inputs_at(tick, TURNED, waits=waits)).pulse for tick in range(0, 6000, 500)}
        assert {pulse.coil for pulse in found if pulse.level} == {0, 1, 2} - {coil}

    @pytest.mark.parametrize("memory", [(1.0, 2.0), (9e9,), (0.0,) * 136])
    def test_what_another_law_remembered_is_not_looked_at(self, memory):
        assert ask(inputs_at(500, TURNED), memory) == ask(inputs_at(500, TURNED))

    def test_coils_with_a_back_off_of_their_own_take_turns(self):
        memory, fired, free_at = (), [], [0, 0, 0]
        for tick in range(400):
            waits = tuple(max(at - tick, 0) for at in free_at)
            asked = ask(inputs_at(tick, TURNED, waits=waits, config=PER_COIL), memory, PER_COIL)
            memory = asked.memory
            if asked.pulse.level:
                fired.append((tick, asked.pulse.coil))
                free_at[asked.pulse.coil] = tick + 103
        ticks = [tick for tick, _ in fired]
        assert len(fired) > 400 / 103 + 1
        assert min(np.diff(ticks)) >= 35


@pytest.mark.parametrize("missing", ["attitude", "reference", "ephemeris", "schedule", "pulses"])
def test_without_knowledge_nothing_is_asked_for(missing):
    inputs, control = inputs_at(500, TURNED), CONFIG.control
    if missing == "schedule":
        control = replace(control, schedules={})
    elif missing == "pulses":
        control = replace(control, pulse_model=None)
    else:
        inputs = inputs.replace(**{missing: UNKNOWN if missing == "attitude" else None})
    asked = pulse_mpc(inputs, (7.0,), control.setpoint, control)
    assert (asked.pulse, asked.m_body_am2, asked.memory) == (None, ZERO, (7.0,))


def test_in_point_a_pulse_is_asked_for_as_it_is_without_taking_off_the_residual_dipole():
    inputs = inputs_at(500, TURNED, dipole_am2=(0.05, -0.03, 0.08))
    control = CONFIG.control
    asked = by_mode.demand(Mode.POINT, inputs, (), control.setpoint, control)
    assert asked == ask(inputs)
    assert asked.m_body_am2 == ZERO


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("gains", "told"),
    [
        ({"horizon_orbits": 0.01}, "horizon_orbits must be 0.05 to 1, not 0.01"),
        ({"horizon_orbits": 2.0}, "horizon_orbits must be 0.05 to 1, not 2"),
        ({"effort": 0.0}, "effort 1e-6 to 1e6"),
    ],
)
def test_gains_out_of_range_are_told(gains, told):
    with pytest.raises(ValueError, match=told):
        PulseMpcGains(**gains)


class TestAhead:
    """What the search is told of the opportunities to come, of an orbit that is no circle."""

    TICK, DIPOLE = 2100, (0.02, -0.03, 0.05)

    @pytest.fixture(params=[DIPOLE, ZERO], ids=["dipole", "none"])
    def dipole(self, request):
        return request.param

    @pytest.fixture
    def told(self, monkeypatch, dipole):
        """The opportunities, and what stands at the end of the field looked at."""
        seen = {}

        def search(state, ahead, *rest):
            seen["ahead"] = ahead
            return NO_PULSE

        def costs(problem, ahead, dipole_am2, last):
            seen.setdefault("end", (ahead.b_orbit_t, last))
            return _costs(problem, ahead, dipole_am2, last)

        monkeypatch.setattr("fsw.core.laws.pulse_mpc.first_pulse", search)
        monkeypatch.setattr("fsw.core.laws.pulse_mpc._costs", costs)
        ask(inputs_at(self.TICK, TURNED, config=FAR_SIGHTED, dipole_am2=dipole), config=FAR_SIGHTED)
        return seen

    @property
    def middle_unix_s(self):
        """Of the pulse that would be fired now."""
        return FAR_SIGHTED.ephemeris.epoch_unix_s + self.TICK + 0.5 * FAR_SIGHTED.control.horizon_s

    def orbit_at(self, steps):
        step_s = FAR_SIGHTED.control.pulse_model.problem.step_s
        times = self.middle_unix_s + step_s * np.asarray(steps)
        return orbit_ahead(FAR_SIGHTED.ephemeris, times.tolist())

    @pytest.mark.interpreted
    def test_a_pulse_acts_in_the_field_of_its_middle(self, told):
        pulses, ahead = FAR_SIGHTED.control.pulse_model, told["ahead"]
        expected = kicks(pulses, self.orbit_at(np.arange(len(ahead))).b_orbit_t)
        for k in range(1, len(ahead)):
            assert ahead[k].kicks == pytest.approx(expected[k], abs=4e-3 * np.abs(expected).max())

    @pytest.mark.interpreted
    def test_between_two_the_residual_dipole_and_the_changing_rate_move_it(self, told, dipole):
        """G (m_r x b) - (w0' h, w0' h^2 / 2) e3."""
        ahead, problem = told["ahead"], FAR_SIGHTED.control.pulse_model.problem
        middles, h = np.arange(len(ahead)) + 0.5, problem.step_s
        before, after = (self.orbit_at(middles + by).rate_radps for by in (-0.5, 0.5))
        rate_changes = (after - before) / h
        torques_nm = np.cross(dipole, self.orbit_at(middles).b_orbit_t)
        expected = torques_nm @ problem.free[:, 6:].T
        expected[:, 2] -= h * rate_changes
        expected[:, 5] -= 0.5 * h * h * rate_changes
        found = np.array([opportunity.drift for opportunity in ahead])
        for found, wanted in zip(ahead[1:-1], expected[1:-1], strict=True):
            assert found.drift == pytest.approx(wanted, rel=0.02, abs=1e-3 * h * np.abs(rate_changes).max())
        assert np.abs(h * rate_changes).max() > 1e-8

    @pytest.mark.interpreted
    def test_after_those_searched_the_field_is_looked_at_step_by_step_to_the_horizon(self, told):
        """In the middle of each step of the regulator, which begins where the last one searched ends."""
        later_t, table = told["end"][0], FAR_SIGHTED.control.schedules["pulse_mpc"]
        pulses, control = FAR_SIGHTED.control.pulse_model, FAR_SIGHTED.control
        count = round(STEPS * control.gains["pulse_mpc"].horizon_orbits)
        begin_s = pulses.searched * pulses.problem.step_s - 0.5 * control.horizon_s
        middles_s = begin_s + table.problem.step_s * (np.arange(count) + 0.5)
        expected = self.orbit_at(middles_s / pulses.problem.step_s).b_orbit_t
        assert later_t == pytest.approx(expected, abs=0.01 * np.abs(expected).max())

    @pytest.mark.interpreted
    def test_at_the_end_stands_what_the_regulator_of_a_whole_orbit_has_there(self, told):
        later_t, last = told["end"]
        table, pulses = FAR_SIGHTED.control.schedules["pulse_mpc"], FAR_SIGHTED.control.pulse_model
        later_s = pulses.searched * pulses.problem.step_s + len(later_t) * table.problem.step_s
        tick = self.TICK + round(later_s)
        end = node(
            latitude_argument(
                reference_at(advance(None, tick, FAR_SIGHTED.ephemeris), tick, FAR_SIGHTED.ephemeris)
            )
        )
        near = [table.costs[(end + by) % STEPS] for by in (-1, 0, 1)]
        assert any(np.array_equal(last[:, :9], cost) for cost in near)
        assert not np.any(last[:, 9])


@dataclass
class Flight:
    """A linear body about the nominal attitude, a tick at a time, with all that the law is told true."""

    torque_nm: tuple = ZERO
    dipole_am2: tuple = ZERO
    told_dipole: bool = True
    config: object = CONFIG

    def rms_deg(self, orbits, last):
        control, timing = self.config.control, self.config.coils.pulses
        model, pulses = self.config.ephemeris, control.pulse_model
        problem = control.schedules["pulse_mpc"].problem
        rate = reference_at(advance(None, 0, model), 0, model).orbit_rate_radps
        free = free_step(control.inertia_kgm2, ZERO, rate, 1.0)
        x, memory, ready, squares = np.array([0.0, 0.0, 0.0, 0.03, 0.04, -0.02]), (), 0, []
        ticks = int(orbits * 2.0 * np.pi / rate)
        constant = np.array(self.torque_nm) + np.array(problem.resting_nm)
        field = np.zeros(3)
        for tick in range(ticks):
            if tick % 20 == 0:
                reference = reference_at(advance(None, tick, model), tick, model)
                field = np.array(rotate(reference.q_orbit_from_eci, reference.b_eci_t))
            if tick >= ready:
                told = self.dipole_am2 if self.told_dipole else ZERO
                waits, known = READY, {"torque_nm": self.torque_nm, "dipole_am2": told, "config": self.config}
                if len(memory) == 0 or tick >= memory[0]:
                    asked = ask(inputs_at(tick, x[3:], x[:3], waits, **known), memory, self.config)
                    memory = asked.memory
                    if asked.pulse.level:
                        x[:3] += kicks(pulses, field)[pulses.pulses.index(asked.pulse)]
                        ready = tick + timing.pulse_ticks + timing.backoff_ticks
            x = free[:, :6] @ x + free[:, 6:] @ (constant + np.cross(self.dipole_am2, field))
            squares.append(x[3:] @ x[3:])
        return float(np.degrees(np.sqrt(np.mean(squares[-int(last * ticks / orbits) :]))))


class TestPointing:
    @pytest.mark.long
    def test_with_nothing_unknown_a_torque_costs_hardly_more_than_it_must(self):
        """No periodic dipole leaves less than 0.43 deg of 3e-8 N m about each axis of the 50 kg satellite."""
        flight = Flight(torque_nm=(3e-8, 3e-8, 3e-8), config=BALANCED)
        assert 0.4 < flight.rms_deg(2.5, 1.0) < 0.55

    @pytest.mark.long
    def test_a_residual_dipole_that_is_known_costs_little_and_one_that_is_not_much(self):
        dipole = (0.006, -0.005, 0.008)
        known = Flight(dipole_am2=dipole).rms_deg(2.0, 1.0)
        unknown = Flight(dipole_am2=dipole, told_dipole=False).rms_deg(2.0, 1.0)
        assert known < 0.4
        assert unknown > 1.5 * known


@pytest.mark.parametrize(
    ("backoff_s", "backoff"), [(0, "shared"), (20, "shared"), (0, "per_coil"), (160, "shared")]
)
def test_ten_minutes_are_searched_however_short_the_back_off(backoff_s, backoff):
    """Pulses may be fired sooner than planned, never later."""
    coils = {"levels_am2": [0.5, 2.0, 8.0], "backoff_s": backoff_s, "backoff": backoff}
    config = config_of(coils=coils)
    timing, model = config.coils.pulses, config.control.pulse_model
    assert model.rest * model.step_ticks >= max(60, timing.pulse_ticks + timing.backoff_ticks)
    assert model.searched * model.problem.step_s >= 600.0
    assert 6 <= model.searched <= 30


def test_levels_and_timing_of_the_plan_are_those_of_the_scheduler():
    for config, rest in ((CONFIG, 1), (PER_COIL, 3)):
        timing, model = config.coils.pulses, config.control.pulse_model
        assert isinstance(timing, PulseConfig)
        assert model.rest == rest
        assert model.rest * model.step_ticks >= timing.pulse_ticks + timing.backoff_ticks
        assert model.problem.step_s == pytest.approx(model.step_ticks * timing.tick_s)
        body = np.array(config.control.inertia_kgm2)
        impulses_am2_s = np.abs(body @ model.turns)
        assert impulses_am2_s.max() == pytest.approx(timing.levels_am2[2] * timing.pulse_s)
