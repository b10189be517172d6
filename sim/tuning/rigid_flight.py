"""A flight of a rigid body by a law of the flight software, all that the law is given being true.

Body, wheel and torques are the plant's; orbit and field are those of the controller's own models; law,
scheduler and limits of the coils are those that fly. Left out are sensors and filter, the board and the bus,
DETUMBLE and the dwell times of the modes: the law's form is that of POINT from ``modes.near_deg`` until the
error exceeds ``modes.far_deg``, else that of ACQUIRE. A tick is a step. A pulse shorter than a step acts over
the whole of it with the same impulse, and the time from one to the next is a whole number of steps.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fsw.core.actuation import dipoles, pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate, wait_ticks
from fsw.core.actuation.dipoles import DipoleConfig
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.quaternion import canonical, conjugate, multiply, rotate
from fsw.core.algebra.vector import ZERO, Vec3, add, scale, sub
from fsw.core.config import FlightConfig
from fsw.core.estimation.attitude import Attitude
from fsw.core.gate.measurements import CoilReport, Measurements
from fsw.core.laws import by_mode
from fsw.core.laws.interface import FieldSample, LawInput, Memory
from fsw.core.laws.plan.pulse_model import AXES
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, reference_at
from fsw.table.config import flight_config
from fsw.table.schedules import planned_pulses
from fsw.table.sections import BodyTable
from fsw.wire.messages import CoilFire, Mode
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.torques import BodyTorque
from sim.plant.environment.surroundings import Surroundings
from sim.plant.rotation import Quaternion
from sim.scenario.assemble import initial_config
from sim.scenario.schema import Scenario, flight_table, orbit_period_s
from sim.tuning.flown import RigidFlight

# --- Orbit and field of a flight: what the law expects at each step, and what acts at each half step

NODES_HZ = 2
"""The ticks of the ephemeris: an instant within a step is a whole number of them."""


class Path(NamedTuple):
    """References a step, surroundings a half step with that at the end."""

    references: tuple[Reference, ...]
    around: tuple[Surroundings, ...]


def path_of(model: EphemerisModel, key: str, step_s: float, steps: int) -> Path:
    """Orbit and field over so many steps, computed once for each orbit.

    Raises:
        ValueError: the orbit has no position.
    """
    return _path(_Keyed(key, model), step_s, steps)


class _Keyed:
    """An ephemeris that is the same as another one of the same key."""

    def __init__(self, key: str, model: EphemerisModel) -> None:
        self.key, self.model = key, model

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Keyed) and other.key == self.key


@lru_cache(maxsize=4)
def _path(keyed: _Keyed, step_s: float, steps: int) -> Path:
    given = keyed.model
    model = replace(given, tick_hz=NODES_HZ, node_ticks=given.node_ticks // given.tick_hz * NODES_HZ)
    half_ticks = round(0.5 * step_s * NODES_HZ)
    window, references, around = None, [], []
    for half in range(2 * steps + 1):
        tick = half * half_ticks
        window = advance(window, tick, model)
        if window is None:
            raise ValueError(f"the orbit has no position {tick / NODES_HZ:g} s after its epoch")
        reference = reference_at(window, tick, model)
        if half % 2 == 0:
            references.append(reference)
        gradient = 3.0 * MU_M3PS2 / reference.radius_m**3
        radius = scale(1.0 / reference.radius_m, reference.r_eci_m)
        around.append(Surroundings(radius, gradient, reference.b_eci_t))
    return Path(tuple(references[:-1]), tuple(around))


# --- The flight

STEP_S = 10.0
NO_FAULTS = (0, 0, 0)
REPORTED = Measurements()
REPORTED.coil = CoilReport(0, 0, 0, 0, 0, 0)
"""The board bars no coil: the scheduler's own timers are the limit."""


class SteppedCoils(NamedTuple):
    """The driver of a flight, its timing in steps; a pulse acts for ``share`` of its steps."""

    timing: PulseConfig
    continuous: DipoleConfig | None
    share: float


def fly(scenario: Scenario, orbits: float, step_s: float | None = None) -> RigidFlight:
    """Fly a scenario's body from its initial state by its law.

    Args:
        scenario: what is flown; its sensors, estimator and disturbances but a constant torque and a residual
            dipole do not count.
        orbits: how long.
        step_s: a whole number of seconds; None: ``STEP_S``.
    """
    table = flight_table(scenario)
    config = flight_config(table)
    step_s = step_s or STEP_S
    coils = _coils(config, step_s)
    control = replace(config.control, tick_s=step_s)
    if coils.continuous is None:
        planned = planned_pulses(table, config.ephemeris.orbit, control.gains, coils.timing)
        control = replace(control, pulse_model=planned)
    orbit_s = orbit_period_s(scenario)
    steps = round(orbits * orbit_s / step_s)
    path = path_of(
        config.ephemeris,
        f"{scenario.orbit.model_dump_json()} {table.epoch_unix_s} {table.field}",
        step_s,
        steps,
    )
    return _fly(scenario, replace(config, control=control), coils, path, step_s, orbit_s)


def _fly(
    scenario: Scenario, config: FlightConfig, coils: SteppedCoils, path: Path, step_s: float, orbit_s: float
) -> RigidFlight:
    control, table = config.control, flight_table(scenario).body
    body = RigidBody(table.inertia, table.wheel_nms)
    motion = _first(scenario, path.references[0])
    scheduler, view = pulses.boot(0, coils.timing), CoilView(lockout_ms=(0, 0, 0))
    driver = ActuatorConfig(coils.timing, None)
    disturbing = scenario.disturbance
    memory: Memory = ()
    m_am2 = ZERO
    before, mode = FieldSample(), Mode.ACQUIRE
    rows: list[tuple[Quaternion, Quaternion, Vec3, Vec3, Vec3]] = []
    for tick, reference in enumerate(path.references):
        inputs = law_input(motion, reference, tick, before, config).replace(
            torque_body_nm=disturbing.torque_nm, dipole_body_am2=disturbing.residual_dipole_am2
        )
        before = inputs.sample
        attitude = inputs.attitude if control.axes is None else control.axes.attitude(inputs.attitude)
        mode = _mode(mode, attitude, config)
        waits = wait_ticks(scheduler, view, REPORTED, tick, coils.timing, NO_FAULTS)
        demand = by_mode.demand(mode, inputs.replace(wait_ticks=waits), memory, control.setpoint, control)
        assert demand is not None
        memory = demand.memory
        if coils.continuous is not None:
            asked = dipoles.request(scheduler, demand, inputs.b_body_t, tick, coils.continuous, coils.timing)
            share = 1.0 if demand.impulse_body_nms is None else coils.share
            m_am2 = scale(share * coils.continuous.full_scale_am2, (asked.m_x, asked.m_y, asked.m_z))
        else:
            request = actuate(scheduler, view, demand, inputs.b_body_t, REPORTED, tick, driver, NO_FAULTS)
            if isinstance(request, CoilFire):
                size = coils.share * pulses.dipole_am2(request.level, coils.timing.levels_am2)
                m_am2 = scale(size, AXES[request.coil])
            elif tick >= scheduler.busy_until:
                m_am2 = ZERO
        omega = motion.omega_body_radps
        relative = attitude.omega_body_orbit_radps
        rows.append((motion.q_body_from_eci, attitude.q_body_from_orbit, omega, relative, m_am2))
        dipole_am2 = add(m_am2, disturbing.residual_dipole_am2)
        acting = BodyTorque(table.inertia, dipole_am2, disturbing.torque_nm)
        motion = body.step(motion, acting, step_s, *path.around[2 * tick : 2 * tick + 3])
    return _recorded(rows, table, step_s, orbit_s)


def law_input(
    motion: Motion, reference: Reference, tick: int, before: FieldSample, config: FlightConfig
) -> LawInput:
    """What the law receives of the true motion; ``before`` is the sample of the step before."""
    q = motion.q_body_from_eci
    b_body_t = rotate(q, reference.b_eci_t)
    q_body_from_orbit = canonical(multiply(conjugate(reference.q_orbit_from_eci), q))
    normal = rotate(q_body_from_orbit, (0.0, 0.0, reference.orbit_rate_radps))
    return LawInput(
        attitude=Attitude(q_body_from_orbit, sub(motion.omega_body_radps, normal), 0.0, 0.0, True),
        b_body_t=b_body_t,
        sample=FieldSample(b_body_t, tick),
        before=before,
        sun_body=rotate(q, reference.sun_eci) if reference.lit else None,
        reference=reference,
        tick=tick,
        ephemeris=config.ephemeris,
    )


def _mode(mode: Mode, attitude: Attitude, config: FlightConfig) -> Mode:
    q0, q1, q2, q3 = attitude.q_body_from_orbit
    modes = config.modes
    cosine = q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3 if modes.axis_only else 2.0 * q0 * q0 - 1.0
    if mode is Mode.ACQUIRE:
        return Mode.POINT if cosine >= modes.near_cosine else Mode.ACQUIRE
    return Mode.ACQUIRE if cosine < modes.far_cosine else Mode.POINT


def _coils(config: FlightConfig, step_s: float) -> SteppedCoils:
    """The driver with its timing in steps."""
    timing = config.coils.pulses
    pulse_steps = max(1, int(timing.pulse_s / step_s + 1e-9))
    period_steps = max(
        pulse_steps + 1, round((timing.pulse_s + timing.backoff_ticks * timing.tick_s) / step_s)
    )
    stepped = replace(
        timing, pulse_ticks=pulse_steps, backoff_ticks=period_steps - pulse_steps, tick_s=step_s
    )
    return SteppedCoils(stepped, config.coils.dipoles, timing.pulse_s / (pulse_steps * step_s))


def _first(scenario: Scenario, reference: Reference) -> Motion:
    start = initial_config(scenario)
    normal = rotate(start.q_body_from_orbit, (0.0, 0.0, reference.orbit_rate_radps))
    q_body_from_eci = multiply(reference.q_orbit_from_eci, start.q_body_from_orbit)
    return Motion(q_body_from_eci, add(start.omega_body_orbit_radps, normal))


def _recorded(
    rows: Sequence[tuple[Quaternion, Quaternion, Vec3, Vec3, Vec3]],
    body: BodyTable,
    step_s: float,
    orbit_s: float,
) -> RigidFlight:
    q_eci, q_orbit, omega, relative, m = (
        np.array(column, dtype=np.float64) for column in zip(*rows, strict=True)
    )
    momentum = omega @ np.array(body.inertia).T + np.array(body.wheel_nms)
    t_s = step_s * np.arange(len(rows), dtype=np.float64)
    return RigidFlight(orbit_s, t_s, q_orbit, relative, q_eci, omega, momentum, m)
