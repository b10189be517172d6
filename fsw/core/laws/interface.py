"""What a control law sees, what it may ask for, and what it is tuned by."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, final

from fsw.core.algebra.vector import ZERO, Mat3, Vec3
from fsw.core.estimation.attitude import Attitude
from fsw.core.laws.plan.law_axes import LawAxes
from fsw.core.laws.plan.pulse_model import NEVER, Pulse, PulseModel
from fsw.core.laws.plan.riccati import Schedule
from fsw.core.orbit.ephemeris import EphemerisModel, Reference
from fsw.wire.value import Value

Memory = tuple[float, ...]
"""What a law carries from one tick to the next; empty when it begins."""


@final
class FieldSample(Value):
    """The last usable field sample, body axes, and its tick (-1: none)."""

    FIELDS = ("b_body_t", "tick")
    __slots__ = FIELDS

    def __init__(self, b_body_t: Vec3 = ZERO, tick: int = -1) -> None:
        self.b_body_t = b_body_t
        self.tick = tick


@final
class LawInput(Value):
    """What a law receives in one tick; its body axes are 1 up, 2 ahead, 3 along the orbit's normal.

    ``b_body_t`` is the modelled field where the attitude is usable, otherwise the last measured one;
    ``sample`` and ``before`` are the last usable field sample of this tick and of the tick before;
    ``sun_body`` is the measured Sun direction, with Sun cells the coarse one of three lit ones, None where
    there is none; ``reference`` is orbit, field and Sun as modelled, None where no orbit is known;
    ``torque_body_nm`` is the estimated torque on the nominal attitude, including that of an inertia other
    than the table's, and ``dipole_body_am2`` the estimated residual dipole, which ``by_mode`` subtracts from
    a demanded dipole, not the law; ``tick`` is this tick;
    ``ephemeris`` gives orbit and field at later times; ``wait_ticks`` are the ticks until each coil may be
    fired as far as is known, 0: in answer to this tick, ``NEVER``: it has a fault; ``wheel_nms`` is the
    momentum of a driven wheel relative to the body, along its axis, None where there is none or it is not
    known.
    """

    FIELDS = (
        *("attitude", "b_body_t", "sample", "before", "sun_body", "reference", "torque_body_nm"),
        *("dipole_body_am2", "tick", "ephemeris", "wait_ticks", "wheel_nms"),
    )
    __slots__ = FIELDS

    def __init__(
        self,
        attitude: Attitude,
        b_body_t: Vec3,
        sample: FieldSample,
        before: FieldSample,
        sun_body: Vec3 | None = None,
        reference: Reference | None = None,
        torque_body_nm: Vec3 = ZERO,
        dipole_body_am2: Vec3 = ZERO,
        tick: int = 0,
        ephemeris: EphemerisModel | None = None,
        wait_ticks: tuple[int, int, int] = (NEVER, NEVER, NEVER),
        wheel_nms: float | None = None,
    ) -> None:
        self.attitude = attitude
        self.b_body_t = b_body_t
        self.sample = sample
        self.before = before
        self.sun_body = sun_body
        self.reference = reference
        self.torque_body_nm = torque_body_nm
        self.dipole_body_am2 = dipole_body_am2
        self.tick = tick
        self.ephemeris = ephemeris
        self.wait_ticks = wait_ticks
        self.wheel_nms = wheel_nms


@dataclass(frozen=True, slots=True)
class Wheel:
    """A reaction wheel that can be driven, as the onboard table knows it.

    Attributes:
        axis_body: unit vector along its axis, body axes.
        inertia_kgm2: of the wheel about its axis.
        max_torque_nm: of its motor.
        max_momentum_nms: relative to the body.
        viscous_nms: c of the friction c W, W its speed relative to the body.
        coulomb_nm: friction that is nearly constant.
        tick_s: length of a tick.
        stale_ticks: age of its last report from which its momentum counts as unknown.
    """

    axis_body: Vec3
    inertia_kgm2: float
    max_torque_nm: float
    max_momentum_nms: float
    viscous_nms: float
    coulomb_nm: float
    tick_s: float
    stale_ticks: int


MAX_SPIN_RADPS = 0.1
"""Largest spin that a setpoint may hold."""
MAX_GAIN = 1e12
"""Largest gain that a setpoint may hold: a hundred times that of a satellite of many tons."""


@final
@dataclass(frozen=True, slots=True)
class Setpoint:
    """What the ground may change in flight: law, gains, and the spin wanted.

    Units: ``k_w`` N m s/T^2, ``k_a`` N m/T^2, ``k_i`` N m/(T^2 s), ``spin_radps`` rad/s: about body axis 1
    and relative to the orbital frame, for the laws of spin about their own axis and inertial.
    """

    law: str
    k_w: float
    k_a: float
    k_i: float
    spin_radps: float


@dataclass(frozen=True, slots=True)
class OwnLaw:
    """A law that is not in the table of laws: its name in the setpoint, its forms in ACQUIRE and POINT."""

    name: str
    acquire: "Law"
    point: "Law"


@dataclass(frozen=True, slots=True)
class ControlConfig:
    """Parameters of the laws that the onboard table fixes, in the axes that the laws count by.

    Attributes:
        setpoint: at boot.
        gains: by law, the parameters that are that law's alone.
        inertia_kgm2: inertia tensor, body axes, as the controller assumes it.
        inertia_inverse: its inverse.
        wheel_body_nms: constant momentum of a wheel, body axes.
        pulsed: whether the coils give pulses, or any dipole each tick.
        tick_s: length of a tick.
        horizon_s: length of a pulse: how far a predictive law looks.
        mean_dipole_am2: mean dipole per axis that the coils can give.
        schedules: by law, the gains over an orbit of the periodic laws.
        pulse_model: what pulsed coils can do, for a law that plans pulses; None with a continuous driver.
        own: a law in addition to those of the table.
        wheel: a wheel that can be driven; None: there is none.
        axes: those axes; None: they are the body axes.
    """

    setpoint: Setpoint
    gains: dict[str, Any]
    inertia_kgm2: Mat3
    inertia_inverse: Mat3
    wheel_body_nms: Vec3
    pulsed: bool
    tick_s: float
    horizon_s: float
    mean_dipole_am2: float
    schedules: dict[str, Schedule] = field(default_factory=dict)
    pulse_model: PulseModel | None = None
    own: OwnLaw | None = None
    wheel: Wheel | None = None
    axes: LawAxes | None = None


@final
class Demand(Value):
    """The demand of a law: a mean dipole, an angular impulse to be given at the next opportunity, or a pulse.

    An impulse law leaves the dipole to the actuator, which chooses the one with the least energy left. A law
    of pulses says in each tick which one is to be fired in answer to it; ``NO_PULSE``: none, and
    no dipole of a continuous driver. With any of them, ``wheel_torque_nm`` is the torque on the wheel about
    its axis, the opposite of that on the body; None: the wheel coasts.
    """

    FIELDS = ("m_body_am2", "impulse_body_nms", "memory", "pulse", "wheel_torque_nm")
    __slots__ = FIELDS

    def __init__(
        self,
        m_body_am2: Vec3 = ZERO,
        impulse_body_nms: Vec3 | None = None,
        memory: Memory = (),
        pulse: Pulse | None = None,
        wheel_torque_nm: float | None = None,
    ) -> None:
        self.m_body_am2 = m_body_am2
        self.impulse_body_nms = impulse_body_nms
        self.memory = memory
        self.pulse = pulse
        self.wheel_torque_nm = wheel_torque_nm

    def without_memory(self) -> "Demand":
        """The same, of which the law remembers nothing."""
        return Demand(self.m_body_am2, self.impulse_body_nms, (), self.pulse, self.wheel_torque_nm)


Law = Callable[[LawInput, Memory, Setpoint, ControlConfig], Demand]
"""One control law: pure, called once a tick."""
