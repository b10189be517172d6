"""A flight of a linear body with the shipped law and scheduler, all that the law is given being true.

About the nominal attitude the body moves as in ``fsw/core/laws/plan/riccati.py``, a tick at a time, in body
axes; orbit and field are those of the controller's own models, and a pulse acts over its whole length:

    x+ = F x + G (d + (m + m_r) x b) - (w0' h, w0' h^2 / 2) e3

x = (Omega, theta), m the coils' dipole, m_r the residual one, d the constant torque with that on the nominal
attitude, w0' the change of the orbit's rate. Left out are sensors and filter, what the coil board adds (it
reports one coil a tick, so that a pulse may come some ticks later), the turn of the orbit's plane, some 4e-10
N m, and all that is no small angle.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, inf, pi, sqrt
from typing import NamedTuple

import numpy as np

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import CoilView, actuate, wait_ticks
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, scale
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import Attitude
from fsw.core.gate.measurements import CoilReport, Measurements
from fsw.core.laws import by_mode
from fsw.core.laws.interface import FieldSample, LawInput, Memory
from fsw.core.laws.plan.pulse_model import AXES
from fsw.core.laws.plan.riccati import free_step, resting_torque, skews
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, reference_at
from fsw.table.config import flight_config
from fsw.wire.messages import CoilFire, Mode
from sim.scenario.schema import Scenario, flight_table
from sim.value_types import Array

ORBITS, COUNTED = 6.0, 0.5
"""Flown, and the last part of them that counts."""
LOST_DEG = 20.0
"""Beyond it an angle is not small."""
NO_FAULTS = (0, 0, 0)
REPORTED = Measurements()
REPORTED.coil = CoilReport(0, 0, 0, 0, 0, 0)


class Fired(NamedTuple):
    """A pulse: the tick it begins after, its coil 0..2 and level -3..3."""

    tick: int
    coil: int
    level: int


@dataclass(frozen=True, slots=True)
class LinearFlight:
    """What was flown: |theta| in deg after each tick, as far as it was flown, and the pulses."""

    error_deg: Array
    fired: tuple[Fired, ...]
    ticks: int

    def rms_deg(self) -> float:
        """RMS of the error over the part of the flight that counts; infinite where it was lost."""
        if len(self.error_deg) < self.ticks:
            return inf
        return float(np.sqrt(np.mean(self.error_deg[-round(COUNTED * self.ticks) :] ** 2)))


class Passed(NamedTuple):
    """What the satellite meets in a tick: the reference, the field in orbital axes and w0'."""

    reference: Reference
    b_orbit_t: Vec3
    rate_change_radps2: float


def orbits_of(config: FlightConfig, orbits: float = ORBITS) -> list[Passed]:
    """So many orbits from the first tick on."""
    return list(_path(config.ephemeris, round(orbits * 2.0 * pi / orbit_rate_radps(config) * config.tick_hz)))


def _path(model: EphemerisModel, ticks: int) -> Iterator[Passed]:
    """The orbit a tick at a time.

    Raises:
        ValueError: the orbit has no position.
    """
    window, before = None, None
    for tick in range(ticks + 1):
        window = advance(window, tick, model)
        if window is None:
            raise ValueError(f"the orbit has no position in tick {tick}")
        reference = reference_at(window, tick, model)
        if before is not None:
            change = (reference.orbit_rate_radps - before.orbit_rate_radps) * model.tick_hz
            yield Passed(before, rotate(before.q_orbit_from_eci, before.b_eci_t), change)
        before = reference


def fly(
    scenario: Scenario, theta_rad: Vec3, met: Sequence[Passed], torque_known: bool = True
) -> LinearFlight:
    """Fly a scenario's body, coils, torque and residual dipole by its law, in POINT.

    Args:
        scenario: what is flown; its sensors do not count.
        theta_rad: attitude at first, at rest.
        met: the orbit, for as long as is flown.
        torque_known: whether the law knows torque and residual dipole; not with ``knowledge = "perfect"``.
    """
    config = flight_config(flight_table(scenario))
    torque_nm, residual_am2 = scenario.disturbance.torque_nm, scenario.disturbance.residual_dipole_am2
    known = (torque_nm, residual_am2) if torque_known else (ZERO, ZERO)
    body, timing = LinearBody(config, torque_nm), config.coils.pulses
    scheduler, view = pulses.boot(0, timing), CoilView(lockout_ms=(0, 0, 0))  # the board bars no coil
    x, m_am2, until = np.array([*ZERO, *theta_rad]), ZERO, 0
    memory: Memory = ()
    errors: list[float] = []
    fired: list[Fired] = []
    for tick, passed in enumerate(met):
        inputs = law_input(x, passed, tick, config, known)
        waits = wait_ticks(scheduler, view, REPORTED, tick, timing, NO_FAULTS)
        demand = by_mode.demand(
            Mode.POINT, inputs.replace(wait_ticks=waits), memory, config.control.setpoint, config.control
        )
        memory = demand.memory if demand is not None else ()
        request = actuate(scheduler, view, demand, inputs.b_body_t, REPORTED, tick, config.coils, NO_FAULTS)
        if isinstance(request, CoilFire):
            fired.append(Fired(tick, request.coil, request.level))
            m_am2 = scale(pulses.dipole_am2(request.level, timing.levels_am2), AXES[request.coil])
            until = tick + timing.pulse_ticks
        driven = add(residual_am2, m_am2) if tick < until else residual_am2
        x = body.moved(x, cross(driven, inputs.b_body_t), passed.rate_change_radps2)
        errors.append(degrees(sqrt(x[3:] @ x[3:])))
        if errors[-1] > LOST_DEG:
            break
    return LinearFlight(np.array(errors), tuple(fired), len(met))


def orbit_rate_radps(config: FlightConfig) -> float:
    """The rate of the circle that the laws plan for."""
    schedule = config.control.schedules["mpc"]
    return 2.0 * pi / (schedule.problem.step_s * len(schedule.gains))


class LinearBody:
    """The motion over a tick."""

    def __init__(self, config: FlightConfig, torque_nm: Vec3) -> None:
        """Of a body under a constant torque, body axes, beside that on the nominal attitude."""
        control, rate_radps = config.control, orbit_rate_radps(config)
        self._h = 1.0 / config.tick_hz
        free = free_step(control.inertia_kgm2, control.wheel_body_nms, rate_radps, self._h)
        resting_nm = resting_torque(control.inertia_kgm2, control.wheel_body_nms, rate_radps)
        self._f, self._g = free[:, :6], free[:, 6:]
        self._constant = np.array(add(torque_nm, resting_nm))

    def moved(self, x: Array, torque_nm: Vec3, rate_change_radps2: float) -> Array:
        """The state a tick later, under one more torque."""
        after: Array = self._f @ x + self._g @ (self._constant + torque_nm)
        after[2] -= self._h * rate_change_radps2
        after[5] -= 0.5 * self._h * self._h * rate_change_radps2
        return after


def law_input(
    x: Array, passed: Passed, tick: int, config: FlightConfig, known: tuple[Vec3, Vec3]
) -> LawInput:
    """What the law receives, no coil ready; ``known`` are torque and residual dipole."""
    o1, o2, o3, *theta = x.tolist()
    half = [0.5 * part for part in theta]
    q = (sqrt(1.0 - sum(part * part for part in half)), half[0], half[1], half[2])
    b_body_t = rotate(q, passed.b_orbit_t)
    sample = FieldSample(b_body_t, tick)
    attitude = Attitude(q, (o1, o2, o3), 0.0, 0.0, True)
    torque_nm, dipole_am2 = known
    return LawInput(
        attitude,
        b_body_t,
        sample,
        sample,
        None,
        passed.reference,
        torque_nm,
        dipole_am2,
        tick,
        config.ephemeris,
    )


# --- The least error that any dipole leaves of a constant torque, on the orbit that is flown

HELD_S = 60.0
PARTS = 2
"""Of the time for which a dipole is held: after each theta counts."""
TOLERANCE = 1e-6
"""Dipoles with less than this part of the effect of the most effective one are not used."""


def least_deg(config: FlightConfig, torque_nm: Vec3, met: Sequence[Passed]) -> float:
    """The RMS of the least error, deg; a residual dipole costs nothing, since its opposite is a dipole.

    As ``sim/design/theory/feedforward.py``, which needs a field that repeats: here the field is the one met,
    the dipole is held over steps, and the attitude at first and the dipoles are those with the least mean
    square of theta over the part of the flight that counts. The motion is that of the linear body. No law
    does better: it would have to know the field of all orbits to come, and have coils that give any dipole at
    any time.

    Args:
        config: the body, and the length of a tick.
        torque_nm: constant torque, body axes, beside that on the nominal attitude.
        met: the orbit flown.
    """
    held = round(HELD_S * config.tick_hz)
    counted = met[len(met) - round(COUNTED * len(met)) :]
    middles = counted[held // 2 : len(counted) // held * held : held]
    rows = _theta_by_choice(config, torque_nm, middles)
    chosen = np.linalg.lstsq(rows[:, :-1], -rows[:, -1], rcond=TOLERANCE)[0]
    theta = (rows[:, :-1] @ chosen + rows[:, -1]).reshape(-1, 3)
    return degrees(np.sqrt(np.mean(np.sum(theta**2, axis=1))))


def _theta_by_choice(config: FlightConfig, torque_nm: Vec3, middles: Sequence[Passed]) -> Array:
    """Theta after each part of a step by state at first, dipoles of the n steps, and 1: (.., 6 + 3 n + 1)."""
    control, rate_radps, h = config.control, orbit_rate_radps(config), HELD_S / PARTS
    free = free_step(control.inertia_kgm2, control.wheel_body_nms, rate_radps, h)
    constant = add(torque_nm, resting_torque(control.inertia_kgm2, control.wheel_body_nms, rate_radps))
    pushes = -free[:, 6:] @ skews(np.array([passed.b_orbit_t for passed in middles]))
    state, rows = np.hstack([np.eye(6), np.zeros((6, 3 * len(middles) + 1))]), []
    for step, passed in enumerate(middles):
        for _ in range(PARTS):
            state = free[:, :6] @ state
            state[:, 6 + 3 * step : 9 + 3 * step] += pushes[step]
            state[:, -1] += free[:, 6:] @ constant
            state[[2, 5], -1] -= passed.rate_change_radps2 * h * np.array([1.0, 0.5 * h])
            rows.append(state[3:].copy())
    return np.concatenate(rows)
