"""The plant: physics and boards, tick by tick, with frames as output and input."""

from typing import Literal
from zlib import crc32

from mypy_extensions import mypyc_attr

from fsw.wire.frame import Frame
from fsw.wire.messages import PlantBoot, PlantEnd, PlantHeartbeat, RefAttitude, RefRate, Sync
from hil_stub.node import CONTRACT_VERSION, HEARTBEAT_S
from hil_stub.sensors.magnetometer import Magnetometer
from sim.plant.coil_drive import OFF
from sim.plant.config import PlantConfig
from sim.plant.dynamics import torques
from sim.plant.dynamics.disturbances import TorqueNoise, bias_torque, effects, residual_dipole
from sim.plant.dynamics.rigid_body import Motion, RigidBody
from sim.plant.dynamics.substeps import Substeps, lost
from sim.plant.dynamics.wheel import WheelStep
from sim.plant.hardware.actuators import Actuator, make_actuator
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
    add,
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


@mypyc_attr(allow_interpreted_subclasses=True)
class Plant:
    """Satellite, environment and boards.

    In each tick: ``begin_tick`` and send its frames; ``receive`` each frame of the answer; ``end_tick``.
    ``truth`` is that of the instant of the tick that has begun. The same configuration gives the same frames
    and truth to the last bit.

    Args:
        config: the plant.
        actuator: drives the coils in place of the plant's own board.
        own: user effects on body and sensors.

    Raises:
        ValueError: the orbit elements are malformed, or orbit or field do not exist at the epoch.
    """

    def __init__(
        self, config: PlantConfig, actuator: Actuator | None = None, own: OwnEffects = NO_EFFECTS
    ) -> None:
        self._config, self._disturbance = config, config.disturbance
        self.tick_hz = config.tick_hz
        """Ticks a second."""
        self._substeps = Substeps(config)
        self._environment = self._substeps.environment
        inertia, wheel = config.body.inertia_kgm2, config.wheel
        own_inertia = inertia if wheel is None else wheel.rest_of(inertia)
        self._body = RigidBody(own_inertia, config.body.wheel_body_nms)
        self._inertia = inertia
        effect_by_name = effects(config)
        self._effects, self._own = tuple(effect_by_name.values()), own
        root_density = config.disturbance.torque_noise_nm_rts
        self._noise = TorqueNoise(root_density, config.seed, config.tick_hz) if root_density else None
        last = [*(["noise"] if root_density else []), *(["wheel"] if wheel is not None else [])]
        self.torque_sources = (*torques.SOURCES, *effect_by_name, *last, *own.torque_sources)
        """Names of the torques, in the order of ``TruthRow.torque_body_nm``."""
        self._coils = Coils(config.coils)
        self._magnetometer = MagnetometerPhysics(config.magnetometer, config.seed, config.tick_hz)
        self._sun = make_sun_sensing(config)
        self._actuator = actuator or make_actuator(config)
        self._magnetometer_board = Magnetometer(config.tick_hz)
        self.interference: Interference = own if own.any else NO_INTERFERENCE
        """The effect of faults between physics and boards."""
        self.coil_drive = OFF
        """The currents that flowed over the last complete tick."""
        self._tick = 0
        self._mean_dipole_am2 = self._noise_body_nm = self._reaction_nm = ZERO
        self.motion = self._initial_motion()
        """Attitude and rate relative to the inertial frame at the instant of the tick."""
        omega = self.motion.omega_body_radps
        self._wheel = None if wheel is None else WheelUnit(wheel, config.tick_hz, omega)
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
        tick, coils, wheel = self._tick, self._coils, self._wheel
        faulty, sample = self.interference, self._sample
        b_t, b_valid = self._magnetometer.measure(self._b_body_t, coils.dipole_body_am2, self.t_s, sample.lit)
        b_t, b_valid = faulty.field(b_t, b_valid)
        view = SunView(self._body_from_eci, sample.r_eci_m, sample.sun_eci, self._sun_body, sample.lit)
        frames: list[Frame] = []
        frames += self._magnetometer_board.begin_tick(tick, b_t, b_valid)
        frames += self._sun.begin_tick(tick, view, faulty)
        frames += self._actuator.begin_tick(tick, coils.readback_a)
        if wheel is not None:
            frames += wheel.begin_tick(tick, self.motion.omega_body_radps)
        self._add_own_frames(frames)
        frames.append(Sync(tick, self._config.epoch_unix_s + tick // self.tick_hz).encode())
        return frames

    def receive(self, frame: Frame) -> None:
        """Hand a frame of this tick's answer to the boards that take requests."""
        self._actuator.receive(frame)
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
        drive = self.interference.coil_drive(self._actuator.drive())
        self.coil_drive = drive
        if self._noise is not None:
            self._noise_body_nm = self._noise.next()
        tick, motion, wheel = self._tick, self.motion, self._wheel
        wheel_nms = 0.0
        driven: WheelStep | None = None
        if wheel is not None:
            wheel.drive()
            wheel_nms = wheel.momentum_nms(motion.omega_body_radps)
        steps = self._substeps.of(tick, motion.omega_body_radps, wheel_nms)
        number, step_s, stages = steps.number, steps.step_s, steps.stages
        sx = sy = sz = 0.0
        for substep in range(number):
            on_s = step_s * min(max(drive.fraction * number - substep, 0.0), 1.0)
            m_body_am2 = self._coils.advance(drive.current_a, on_s, step_s, drive.held_a)
            sx, sy, sz = sx + m_body_am2[0], sy + m_body_am2[1], sz + m_body_am2[2]
            if wheel is not None:
                driven = wheel.advance(motion.omega_body_radps, step_s)
                self._reaction_nm = driven.reaction_nm
            first = 2 * substep
            motion = self._body.step(
                motion,
                self._torque(m_body_am2),
                step_s,
                stages[first],
                stages[first + 1],
                stages[first + 2],
                driven=driven,
            )
            if not motion.is_sound(step_s):
                raise lost(tick)
        self.motion = motion
        self._mean_dipole_am2 = (sx / number, sy / number, sz / number)
        self._tick = tick + 1
        self._observe()

    def truth(self) -> TruthRow:
        """The truth at t_k, k the tick that has begun."""
        sample, around, omega = self._sample, self._around, self.motion.omega_body_radps
        q_body_from_orbit, omega_body_orbit_radps = self._relative()
        body_from_eci, b_body_t = self._body_from_eci, self._b_body_t
        e_body = transform(body_from_eci, around.e_eci)
        residual = residual_dipole(self._disturbance, sample.lit, self._coils.remanence_body_am2)
        acting = [
            torques.gravity_gradient(self._inertia, e_body, around.gradient_ps2),
            torques.magnetic(self._mean_dipole_am2, b_body_t),
            torques.magnetic(residual, b_body_t),
            self._bias_body_nm(),
        ]
        for effect in self._effects:
            acting.append(effect.at(body_from_eci, omega, around))
        if self._noise is not None:
            acting.append(self._noise_body_nm)
        if self._wheel is not None:
            acting.append(self._reaction_nm)
        acting += self._own.torques_body_nm
        return TruthRow(
            self.t_s,
            q_body_from_orbit,
            omega_body_orbit_radps,
            b_body_t,
            self._sun_body,
            sample.lit,
            self._mean_dipole_am2,
            sample.r_eci_m,
            tuple(acting),
            None if self._wheel is None else self._wheel.momentum_nms(omega),
        )

    def end(self) -> Frame:
        """The last frame of a complete run."""
        return PlantEnd(self._tick).encode()

    def _torque(self, m_body_am2: Vec3) -> torques.BodyTorque:
        """The torque over an integration step in which the coils' mean dipole is ``m_body_am2``."""
        residual = residual_dipole(self._disturbance, self._sample.lit, self._coils.mean_remanence_body_am2)
        bias = add(self._bias_body_nm(), self._noise_body_nm)
        if self._wheel is not None:
            bias = add(bias, self._reaction_nm)
        for torque in self._own.torques_body_nm:
            bias = add(bias, torque)
        return torques.BodyTorque(self._inertia, add(m_body_am2, residual), bias, self._effects)

    def _bias_body_nm(self) -> Vec3:
        """The constant torque with its daily variation, and that of the penumbra, now."""
        return bias_torque(self._disturbance, self.t_s, self._sample.lit)

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
        self._around = self._environment.start(self._tick)
        self._body_from_eci = matrix(self.motion.q_body_from_eci)
        self._b_body_t = transform(self._body_from_eci, sample.b_eci_t)
        self._sun_body = transform(self._body_from_eci, sample.sun_eci)
        if self._own.any:
            self._own.observe(
                Moment(
                    self.t_s,
                    self.motion.q_body_from_eci,
                    self.motion.omega_body_radps,
                    self._b_body_t,
                    self._sun_body,
                    sample.lit,
                    sample.r_eci_m,
                    sample.v_eci_mps,
                )
            )

    def _relative(self) -> tuple[Quaternion, Vec3]:
        """Attitude and rate relative to the orbital frame."""
        sample, (x, y, z) = self._sample, self.motion.omega_body_radps
        q_orbit_from_eci = from_matrix(sample.orbit_from_eci)
        nx, ny, nz = transform(self._body_from_eci, sample.orbit_from_eci[2])
        rate = sample.orbit_rate_radps
        return (
            canonical(multiply(conjugate(q_orbit_from_eci), self.motion.q_body_from_eci)),
            (x - rate * nx, y - rate * ny, z - rate * nz),
        )

    def _add_own_frames(self, frames: list[Frame]) -> None:
        tick = self._tick
        if tick == 0:
            wheel = self._config.wheel
            table_crc = crc32(f"{self._config!r}{'' if wheel is None else repr(wheel)}".encode())
            frames.append(PlantBoot(reason=0, version=CONTRACT_VERSION, table_crc=table_crc).encode())
        if self._config.perfect_knowledge:
            (_, x, y, z), (wx, wy, wz) = self._relative()
            most = _REF_RATE_RANGE_RADPS
            in_range = abs(wx) < most and abs(wy) < most and abs(wz) < most
            frames.append(RefAttitude(1, x, y, z, counter=tick).encode())
            frames.append(RefRate(int(in_range), wx, wy, wz, counter=tick).encode())
        beats, rest = divmod(tick, HEARTBEAT_S * self._config.tick_hz)
        if beats and not rest:
            frames.append(PlantHeartbeat(0, 0, self.slips, tick, counter=beats - 1).encode())
