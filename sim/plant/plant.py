"""The plant: physics and boards, tick by tick, with frames as output and input."""

from typing import Literal
from zlib import crc32

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, PlantHeartbeat, RefAttitude, RefRate, Sync
from hil_stub.node import CONTRACT_VERSION, HEARTBEAT_S
from hil_stub.sensors.magnetometer import Magnetometer
from sim.plant.config import PlantConfig
from sim.plant.dynamics import torques
from sim.plant.dynamics.disturbances import bias_torque, effects, residual_dipole, torque_noise
from sim.plant.dynamics.rigid_body import Motion, RigidBody, Torque
from sim.plant.dynamics.substeps import Substeps, lost
from sim.plant.environment.surroundings import Surroundings
from sim.plant.hardware.actuators import Actuator, CoilDrive, make_actuator
from sim.plant.hardware.coils import Coils
from sim.plant.hardware.sensors import MagnetometerPhysics
from sim.plant.hardware.sun_sensing import SunView, make_sun_sensing
from sim.plant.hardware.wheel_unit import WheelUnit
from sim.plant.interference import NO_INTERFERENCE, Interference
from sim.plant.own_effects import NO_EFFECTS, Moment, OwnEffects
from sim.plant.rotation import (
    ZERO,
    Quaternion,
    Vec3,
    canonical,
    conjugate,
    from_matrix,
    matrix,
    multiply,
    normalise,
    transform,
)
from sim.plant.truth_row import TruthRow

_REF_RATE_RANGE_RADPS = 0.125
"""Range of ``REF_RATE``; beyond it the rate is sent as not valid."""


class Plant:
    """Satellite, environment and boards.

    In each tick: ``begin_tick`` and send its frames; ``receive`` each frame of the answer; ``end_tick``.
    ``truth`` is that of the instant of the tick that has begun. The same configuration gives the same frames
    and truth to the last bit.

    Args:
        config: the plant.
        actuator: drives the coils in place of the plant's own board.
        own: effects of one's own on body and sensors.

    Raises:
        ValueError: the orbit elements are malformed, or orbit or field do not exist at the epoch.
    """

    def __init__(
        self, config: PlantConfig, actuator: Actuator | None = None, own: OwnEffects = NO_EFFECTS
    ) -> None:
        self._config = config
        self.tick_hz = config.tick_hz
        """Ticks a second."""
        self._substeps = Substeps(config)
        self._environment = self._substeps.environment
        inertia, wheel = config.body.inertia_kgm2, config.wheel
        own_inertia = inertia if wheel is None else wheel.rest_of(inertia)
        self._body = RigidBody(own_inertia, config.body.wheel_body_nms)
        effect_by_name, self._noise = effects(config), torque_noise(config)
        self._effects, self._own = tuple(effect_by_name.values()), own
        last = (
            *(("noise",) if self._noise else ()),
            *(("wheel",) if wheel is not None else ()),
            *own.torque_sources,
        )
        self.torque_sources = (*torques.SOURCES, *effect_by_name, *last)
        """Names of the torques, in the order of ``TruthRow.torque_body_nm``."""
        self._coils = Coils(config.coils)
        self._magnetometer = MagnetometerPhysics(config.magnetometer, config.seed, config.tick_hz)
        self._sun = make_sun_sensing(config)
        self._actuator = actuator or make_actuator(config)
        self._magnetometer_board = Magnetometer(config.tick_hz)
        self.interference: Interference = own if own.any else NO_INTERFERENCE
        """The effect of faults between physics and boards."""
        self.coil_drive = CoilDrive(ZERO, 0.0)
        """The currents that flowed over the last complete tick."""
        self._tick = 0
        self._mean_dipole_am2 = self._noise_body_nm = ZERO
        self.motion = self._initial_motion()
        """Attitude and rate relative to the inertial frame at the instant of the tick."""
        omega = self.motion.omega_body_radps
        self._wheel = None if wheel is None else WheelUnit(wheel, config.tick_hz, omega)
        self._reactions_nm: tuple[Vec3, ...] = () if wheel is None else (ZERO,)  # on the body, in a substep
        self._observe()
        self.slips = 0
        """Deadlines missed since boot: counted by the real-time loop, reported in the heartbeat."""

    @property
    def tick(self) -> int:
        """The tick that has begun or is about to begin."""
        return self._tick

    @property
    def t_s(self) -> float:
        """The time of that tick since tick 0 [s]."""
        return self._tick / self._config.tick_hz

    def begin_tick(self) -> list[Frame]:
        """The frames of this tick, in the order in which they are sent.

        Magnetometer, Sun sensor or cells, coil driver, wheel, the plant itself, and ``SYNC`` last; at tick 0
        each node begins with its boot message.
        """
        tick, coils = self._tick, self._coils
        faulty = self.interference
        b_t, b_valid = faulty.field(*self._magnetometer.measure(self._b_body_t, coils.dipole_body_am2))
        sample = self._sample
        view = SunView(self._body_from_eci, sample.r_eci_m, sample.sun_eci, self._sun_body, sample.lit)
        return [
            *self._magnetometer_board.begin_tick(tick, b_t, b_valid),
            *self._sun.begin_tick(tick, view, faulty),
            *self._actuator.board.begin_tick(tick, coils.readback_a),
            *(self._wheel.begin_tick(tick, self.motion.omega_body_radps) if self._wheel else ()),
            *self._own_frames(),
            Sync(tick, self._config.epoch_unix_s + tick // self._config.tick_hz).encode(),
        ]

    def receive(self, frame: Frame) -> None:
        """Hand a frame of this tick's answer to the boards that take requests."""
        self._actuator.board.receive(frame)
        if self._wheel is not None:
            self._wheel.receive(frame)

    def restart(self, board: Literal["magnetometer", "sun", "coil", "wheel"]) -> None:
        """Power-cycle a board before a tick begins: it boots in that tick, without memory of before."""
        config = self._config
        match board:
            case "magnetometer":
                self._magnetometer_board = Magnetometer(config.tick_hz)
            case "sun":
                self._sun.restart()
            case "coil":
                self._actuator = make_actuator(config)
            case "wheel" if self._wheel is not None:
                self._wheel.restart()

    def scale_coil(self, coil: int, scale: float) -> None:
        """Scale the dipole that a coil gives for the same current, beside other scales; -1 reverses it."""
        self._coils.rescale(coil, scale)

    def unscale_coil(self, coil: int, scale: float) -> None:
        """Take back one such scale."""
        self._coils.restore(coil, scale)

    def end_tick(self) -> None:
        """Drive the coils as the coil driver commands, and advance to the next tick.

        Raises:
            PlantError: the motion is not finite, or the orbit or field model ends.
        """
        self.coil_drive = self.interference.coil_drive(self._actuator.drive())
        driven_a, fraction, held_a = self.coil_drive
        if self._noise:
            self._noise_body_nm = next(self._noise)
        motion, wheel = self.motion, self._wheel
        wheel_nms = 0.0
        if wheel is not None:
            wheel.drive()
            wheel_nms = wheel.momentum_nms(motion.omega_body_radps)
        substeps, step_s, stages = self._substeps.of(self._tick, motion.omega_body_radps, wheel_nms)
        sx = sy = sz = 0.0
        for substep in range(substeps):
            on_s = step_s * min(max(fraction * substeps - substep, 0.0), 1.0)
            mx, my, mz = self._coils.advance(driven_a, on_s, step_s, held_a)
            sx, sy, sz = sx + mx, sy + my, sz + mz
            momenta = None
            if wheel is not None:
                momenta, reaction_nm = wheel.advance(motion.omega_body_radps, step_s)
                self._reactions_nm = (reaction_nm,)
            torque, around = self._torque((mx, my, mz)), stages[2 * substep : 2 * substep + 3]
            motion = self._body.step(motion, torque, around, step_s, momenta)
            if not motion.sound(step_s):
                raise lost(self._tick)
        self.motion = motion
        self._mean_dipole_am2 = (sx / substeps, sy / substeps, sz / substeps)
        self._tick += 1
        self._observe()

    def truth(self) -> TruthRow:
        """The truth at t_k, k the tick that has begun."""
        sample, disturbance = self._sample, self._config.disturbance
        q_body_from_orbit, omega_body_orbit_radps = self._relative()
        b_body_t, inertia = self._b_body_t, self._config.body.inertia_kgm2
        around = self._around
        e_body = transform(self._body_from_eci, around.e_eci)
        return TruthRow(
            t_s=self.t_s,
            q_body_from_orbit=q_body_from_orbit,
            omega_body_orbit_radps=omega_body_orbit_radps,
            b_body_t=b_body_t,
            sun_body=self._sun_body,
            lit=sample.lit,
            m_body_am2=self._mean_dipole_am2,
            r_eci_m=sample.r_eci_m,
            torque_body_nm=(
                torques.gravity_gradient(inertia, e_body, around.gradient_ps2),
                torques.magnetic(self._mean_dipole_am2, b_body_t),
                torques.magnetic(
                    residual_dipole(disturbance, sample.lit, self._coils.remanence_body_am2), b_body_t
                ),
                self._bias_body_nm(),
                *(
                    effect(self._body_from_eci, self.motion.omega_body_radps, around)
                    for effect in self._effects
                ),
                *((self._noise_body_nm,) if self._noise else ()),
                *self._reactions_nm,
                *self._own.torques_body_nm,
            ),
            wheel_nms=self._wheel.momentum_nms(self.motion.omega_body_radps) if self._wheel else None,
        )

    def end(self) -> Frame:
        """The last frame of a complete run."""
        return PlantEnd(self._tick).encode()

    def _torque(self, m_body_am2: Vec3) -> Torque:
        """The torque over an integration step in which the coils' mean dipole is ``m_body_am2``."""
        inertia, disturbance, found = self._config.body.inertia_kgm2, self._config.disturbance, self._effects
        residual = residual_dipole(disturbance, self._sample.lit, self._coils.mean_remanence_body_am2)
        (mx, my, mz), (rx, ry, rz) = m_body_am2, residual
        dipole = (mx + rx, my + ry, mz + rz)
        (bx, by, bz), (nx, ny, nz) = self._bias_body_nm(), self._noise_body_nm
        bias = (bx + nx, by + ny, bz + nz)
        for tx, ty, tz in (*self._reactions_nm, *self._own.torques_body_nm):
            bias = (bias[0] + tx, bias[1] + ty, bias[2] + tz)
        if not found:
            return lambda q, omega, around: torques.total(inertia, q, around, dipole, bias)

        def torque(q: Quaternion, omega: Vec3, around: Surroundings) -> Vec3:
            c = matrix(q)
            x, y, z = torques.total(inertia, q, around, dipole, bias)
            for effect in found:
                dx, dy, dz = effect(c, omega, around)
                x, y, z = x + dx, y + dy, z + dz
            return (x, y, z)

        return torque

    def _bias_body_nm(self) -> Vec3:
        """The constant torque with its daily variation, at the instant of the tick."""
        return bias_torque(self._config.disturbance, self.t_s)

    def _initial_motion(self) -> Motion:
        sample, initial = self._environment.sample(0), self._config.initial
        q_body_from_orbit = normalise(initial.q_body_from_orbit)
        x, y, z = initial.omega_body_orbit_radps
        nx, ny, nz = transform(matrix(q_body_from_orbit), (0.0, 0.0, sample.orbit_rate_radps))
        return Motion(
            multiply(from_matrix(sample.orbit_from_eci), q_body_from_orbit), (x + nx, y + ny, z + nz)
        )

    def _observe(self) -> None:
        """Update the environment of this tick, and field and Sun in body axes at its instant."""
        self._sample = sample = self._environment.sample(self._tick)
        self._around = self._environment.stages(self._tick)[0]
        self._body_from_eci = matrix(self.motion.q_body_from_eci)
        self._b_body_t = transform(self._body_from_eci, sample.b_eci_t)
        self._sun_body = transform(self._body_from_eci, sample.sun_eci)
        if self._own.any:
            seen = self._b_body_t, self._sun_body
            self._own.observe(
                Moment(self.t_s, *self.motion, *seen, sample.lit, sample.r_eci_m, sample.v_eci_mps)
            )

    def _relative(self) -> tuple[Quaternion, Vec3]:
        """Attitude and rate relative to the orbital frame."""
        q_body_from_eci, (x, y, z) = self.motion
        q_orbit_from_eci = from_matrix(self._sample.orbit_from_eci)
        nx, ny, nz = transform(self._body_from_eci, self._sample.orbit_from_eci[2])
        rate = self._sample.orbit_rate_radps
        return (
            canonical(multiply(conjugate(q_orbit_from_eci), q_body_from_eci)),
            (x - rate * nx, y - rate * ny, z - rate * nz),
        )

    def _own_frames(self) -> list[Frame]:
        tick, frames = self._tick, []
        if tick == 0:
            wheel = self._config.wheel
            table_crc = crc32(f"{self._config!r}{'' if wheel is None else repr(wheel)}".encode())
            frames.append(PlantBoot(reason=0, version=CONTRACT_VERSION, table_crc=table_crc).encode())
        if self._config.perfect_knowledge:
            (_, x, y, z), omega = self._relative()
            in_range = all(abs(rate) < _REF_RATE_RANGE_RADPS for rate in omega)
            frames.append(RefAttitude(1, x, y, z, counter=tick).encode())
            frames.append(RefRate(int(in_range), *omega, counter=tick).encode())
        beats, rest = divmod(tick, HEARTBEAT_S * self._config.tick_hz)
        if beats and not rest:
            frames.append(PlantHeartbeat(0, 0, self.slips, tick, counter=beats - 1).encode())
        return frames
