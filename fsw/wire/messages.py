"""Messages of the bus: generated from torquer.dbc by tools/generate_messages.py. Do not edit.

Each message is a named tuple of physical values. ``encode`` saturates quantities at the range of their
signal, takes codes modulo their width, and seals the frame with its CRC. ``decode`` only unpacks: length
and CRC are judged by ``intact``.
"""

from enum import IntEnum
from typing import Final, NamedTuple

from fsw.wire.frame import Frame, crc8, id_register, raw, seal


class Mode(IntEnum):
    """Values of ``mode``."""

    SAFE = 0
    DETUMBLE = 1
    ACQUIRE = 2
    POINT = 3


class Gain(IntEnum):
    """Values of ``gain``."""

    K_W = 0
    K_A = 1
    K_I = 2


class Element(IntEnum):
    """Values of ``element``."""

    EPOCH_DAY = 0
    EPOCH_FRACTION = 1
    INCLINATION_DEG = 2
    RAAN_DEG = 3
    ECCENTRICITY = 4
    PERIGEE_DEG = 5
    ANOMALY_DEG = 6
    MOTION_REVPDAY = 7
    BSTAR = 8


class Component(IntEnum):
    """Values of ``component``."""

    MAG_BIAS_X = 0
    MAG_BIAS_Y = 1
    MAG_BIAS_Z = 2
    TORQUE_X = 3
    TORQUE_Y = 4
    TORQUE_Z = 5
    DIPOLE_X = 6
    DIPOLE_Y = 7
    DIPOLE_Z = 8
    COIL_XX = 9
    COIL_XY = 10
    COIL_XZ = 11
    COIL_YX = 12
    COIL_YY = 13
    COIL_YZ = 14
    COIL_ZX = 15
    COIL_ZY = 16
    COIL_ZZ = 17
    INERTIA_XX = 18
    INERTIA_YY = 19
    INERTIA_ZZ = 20
    INERTIA_XY = 21
    INERTIA_XZ = 22
    INERTIA_YZ = 23
    MAG_TURN_X = 24
    MAG_TURN_Y = 25
    MAG_TURN_Z = 26
    MAG_SCALE_X = 27
    MAG_SCALE_Y = 28
    MAG_SCALE_Z = 29
    SUN_TURN_X = 30
    SUN_TURN_Y = 31
    SUN_TURN_Z = 32
    MAG_DELAY = 33
    SUN_DELAY = 34
    CELL_1 = 35
    CELL_2 = 36
    CELL_3 = 37
    CELL_4 = 38
    CELL_5 = 39
    CELL_6 = 40
    CELL_GAIN_1 = 41
    CELL_GAIN_2 = 42
    CELL_GAIN_3 = 43
    CELL_GAIN_4 = 44
    CELL_GAIN_5 = 45
    CELL_GAIN_6 = 46
    EARTH_LIGHT = 47


class CoilRefusedReason(IntEnum):
    """Values of ``reason``."""

    MALFORMED = 1
    WRONG_TICK = 2
    REPEATED_SEQ = 3
    BAD_COIL = 4
    BAD_LEVEL = 5
    BAD_DURATION = 6
    COIL_ON = 7
    LOCKOUT = 8
    SECOND_DIPOLE = 9
    WRONG_BOARD = 10


class WheelStatusResult(IntEnum):
    """Values of ``result``."""

    NONE = 0
    DRIVEN = 1
    MALFORMED = 2
    WRONG_TICK = 3
    SECOND_TORQUE = 4
    BAD_TORQUE = 5
    TOO_FAST = 6
    NO_SPEED = 7


class TcAckResult(IntEnum):
    """Values of ``result``."""

    ACCEPTED = 0
    UNKNOWN = 1
    OUT_OF_RANGE = 2
    INCOMPLETE = 3
    NOT_ALLOWED = 4
    REPEATED = 5


class Severity(IntEnum):
    """Values of ``severity``."""

    INFO = 0
    WARNING = 1
    ERROR = 2
    FATAL = 3


_COIL_FIRE = id_register(0x080)
_COIL_DIPOLE = id_register(0x088)
_WHEEL_TORQUE = id_register(0x090)
_TC_MODE = id_register(0x0A0)
_TC_CLEAR = id_register(0x0A1)
_TC_LAW = id_register(0x0A2)
_TC_SPIN = id_register(0x0A3)
_TC_GAIN = id_register(0x0A4)
_TC_ORBIT_ELEMENT = id_register(0x0A5)
_TC_ORBIT_LOAD = id_register(0x0A6)
_TC_PARAMETER = id_register(0x0A7)
_TC_FREEZE = id_register(0x0A8)
_COIL_STATUS = id_register(0x100)
_COIL_DIPOLE_STATUS = id_register(0x101)
_COIL_REFUSED = id_register(0x108)
_MAG_FIELD = id_register(0x110)
_SUN_VECTOR = id_register(0x118)
_SUN_CELLS = id_register(0x119)
_REF_ATTITUDE = id_register(0x120)
_REF_RATE = id_register(0x121)
_WHEEL_STATUS = id_register(0x128)
_NAV_ATTITUDE = id_register(0x200)
_NAV_RATE = id_register(0x201)
_NAV_QUALITY = id_register(0x202)
_NAV_PARAMETER = id_register(0x203)
_TC_ACK = id_register(0x208)
_PLANT_EVENT = id_register(0x400)
_FSW_EVENT = id_register(0x410)
_COIL_EVENT = id_register(0x420)
_MAG_EVENT = id_register(0x430)
_SUN_EVENT = id_register(0x440)
_WHEEL_EVENT = id_register(0x450)
_PLANT_BOOT = id_register(0x500)
_FSW_BOOT = id_register(0x510)
_COIL_BOOT = id_register(0x520)
_MAG_BOOT = id_register(0x530)
_SUN_BOOT = id_register(0x540)
_WHEEL_BOOT = id_register(0x550)
_PLANT_HEARTBEAT = id_register(0x600)
_FSW_HEARTBEAT = id_register(0x610)
_COIL_HEARTBEAT = id_register(0x620)
_MAG_HEARTBEAT = id_register(0x630)
_SUN_HEARTBEAT = id_register(0x640)
_WHEEL_HEARTBEAT = id_register(0x650)
_PLANT_END = id_register(0x700)


class _CoilFire(NamedTuple):
    level: int  # -3..3, zero is refused
    coil: int
    seq: int  # differs from the last accepted request
    tick: int  # low 8 bits of the tick answered
    duration_ms: int  # [ms]
    counter: int = 0


class CoilFire(_CoilFire):
    """One self-ending pulse, driven over [t_k, t_k + duration) in answer to tick k. There is no OFF message."""

    __slots__ = ()

    ID: Final = 0x080
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.level & 0xF) << 4
            | (self.coil & 0x3) << 8
            | (self.seq & 0xFF) << 16
            | (self.tick & 0xFF) << 24
            | raw(self.duration_ms, 1, 0, 65535) << 32
        )
        return seal(0x080, word, 7, _COIL_FIRE)

    @classmethod
    def decode(cls, data: bytes) -> "CoilFire":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 4 & 0xF ^ 0x8) - 0x8),
            (word >> 8 & 0x3),
            (word >> 16 & 0xFF),
            (word >> 24 & 0xFF),
            (word >> 32 & 0xFFFF),
            (word & 0xF),
        )


class _CoilDipole(NamedTuple):
    m_x: float  # [1]
    m_y: float  # [1]
    m_z: float  # [1]
    counter: int = 0


class CoilDipole(_CoilDipole):
    """Dipole by fractions of the continuous driver's full scale, for the tick it answers. There is no OFF."""

    __slots__ = ()

    ID: Final = 0x088
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (raw(self.m_x, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 4
            | (raw(self.m_y, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 21
            | (raw(self.m_z, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 38
        )
        return seal(0x088, word, 8, _COIL_DIPOLE)

    @classmethod
    def decode(cls, data: bytes) -> "CoilDipole":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 4 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 21 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 38 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            (word & 0xF),
        )


class _WheelTorque(NamedTuple):
    torque: float  # [N m]; the body gets the opposite
    tick: int  # low 8 bits of the tick answered
    counter: int = 0


class WheelTorque(_WheelTorque):
    """Motor torque on the wheel, about its axis, over the tick it answers. There is no OFF."""

    __slots__ = ()

    ID: Final = 0x090
    LENGTH: Final = 6

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (raw(self.torque, 5.960464477539063e-08, -8388608, 8388607) & 0xFFFFFF) << 8
            | (self.tick & 0xFF) << 32
        )
        return seal(0x090, word, 6, _WHEEL_TORQUE)

    @classmethod
    def decode(cls, data: bytes) -> "WheelTorque":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 8 & 0xFFFFFF ^ 0x800000) - 0x800000) * 5.960464477539063e-08,
            (word >> 32 & 0xFF),
            (word & 0xF),
        )


class _TcMode(NamedTuple):
    mode: int
    counter: int = 0


class TcMode(_TcMode):
    """Fly this mode; the mode table goes on from there. A SAFE that the ground asked for lasts until it asks for another mode."""

    __slots__ = ()

    ID: Final = 0x0A0
    LENGTH: Final = 2

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.counter & 0xF) | (self.mode & 0x7) << 4
        return seal(0x0A0, word, 2, _TC_MODE)

    @classmethod
    def decode(cls, data: bytes) -> "TcMode":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x7),
            (word & 0xF),
        )


class _TcClear(NamedTuple):
    counter: int = 0


class TcClear(_TcClear):
    """Forget the monitor trips, so that SAFE may be left."""

    __slots__ = ()

    ID: Final = 0x0A1
    LENGTH: Final = 2

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = self.counter & 0xF
        return seal(0x0A1, word, 2, _TC_CLEAR)

    @classmethod
    def decode(cls, data: bytes) -> "TcClear":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word & 0xF),
        )


class _TcLaw(NamedTuple):
    law: int  # its number in the table of the laws
    counter: int = 0


class TcLaw(_TcLaw):
    """Fly this control law, which begins without a memory."""

    __slots__ = ()

    ID: Final = 0x0A2
    LENGTH: Final = 3

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.counter & 0xF) | (self.law & 0xFF) << 8
        return seal(0x0A2, word, 3, _TC_LAW)

    @classmethod
    def decode(cls, data: bytes) -> "TcLaw":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 8 & 0xFF),
            (word & 0xF),
        )


class _TcSpin(NamedTuple):
    spin: float  # [rad/s]; about body axis 1, relative to the orbital frame
    counter: int = 0


class TcSpin(_TcSpin):
    """The spin that is wanted."""

    __slots__ = ()

    ID: Final = 0x0A3
    LENGTH: Final = 4

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.counter & 0xF) | (raw(self.spin, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 5
        return seal(0x0A3, word, 4, _TC_SPIN)

    @classmethod
    def decode(cls, data: bytes) -> "TcSpin":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 5 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            (word & 0xF),
        )


class _TcGain(NamedTuple):
    gain: int  # k_w N m s/T^2, k_a N m/T^2, k_i N m/(T^2 s)
    exponent: int
    mantissa: int
    counter: int = 0


class TcGain(_TcGain):
    """Fly with this gain: mantissa times 10^exponent."""

    __slots__ = ()

    ID: Final = 0x0A4
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.gain & 0xF) << 4
            | (self.exponent & 0xFF) << 8
            | (self.mantissa & 0xFFFFFFFF) << 16
        )
        return seal(0x0A4, word, 7, _TC_GAIN)

    @classmethod
    def decode(cls, data: bytes) -> "TcGain":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            ((word >> 8 & 0xFF ^ 0x80) - 0x80),
            ((word >> 16 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _TcOrbitElement(NamedTuple):
    element: int  # as in a two-line element set; epoch: days since 1970 and the part of that day
    exponent: int
    mantissa: int
    counter: int = 0


class TcOrbitElement(_TcOrbitElement):
    """One element of an orbit, mantissa times 10^exponent: kept aside until TC_ORBIT_LOAD."""

    __slots__ = ()

    ID: Final = 0x0A5
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.element & 0xF) << 4
            | (self.exponent & 0xFF) << 8
            | (self.mantissa & 0xFFFFFFFF) << 16
        )
        return seal(0x0A5, word, 7, _TC_ORBIT_ELEMENT)

    @classmethod
    def decode(cls, data: bytes) -> "TcOrbitElement":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            ((word >> 8 & 0xFF ^ 0x80) - 0x80),
            ((word >> 16 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _TcOrbitLoad(NamedTuple):
    counter: int = 0


class TcOrbitLoad(_TcOrbitLoad):
    """Fly with the elements kept aside, all of them at once."""

    __slots__ = ()

    ID: Final = 0x0A6
    LENGTH: Final = 2

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = self.counter & 0xF
        return seal(0x0A6, word, 2, _TC_ORBIT_LOAD)

    @classmethod
    def decode(cls, data: bytes) -> "TcOrbitLoad":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word & 0xF),
        )


class _TcParameter(NamedTuple):
    component: int  # as in NAV_PARAMETER
    exponent: int
    mantissa: int
    counter: int = 0


class TcParameter(_TcParameter):
    """The next value of a number that the filter estimates: mantissa times 10^exponent, in SI units."""

    __slots__ = ()

    ID: Final = 0x0A7
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.component & 0x3F) << 4
            | (self.exponent & 0xFF) << 16
            | (self.mantissa & 0xFFFFFFFF) << 24
        )
        return seal(0x0A7, word, 8, _TC_PARAMETER)

    @classmethod
    def decode(cls, data: bytes) -> "TcParameter":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x3F),
            ((word >> 16 & 0xFF ^ 0x80) - 0x80),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _TcFreeze(NamedTuple):
    frozen: int  # 1 keep, 0 estimate
    counter: int = 0


class TcFreeze(_TcFreeze):
    """Keep the parameters of the filter as they are, or estimate them again."""

    __slots__ = ()

    ID: Final = 0x0A8
    LENGTH: Final = 2

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.counter & 0xF) | (self.frozen & 0x1) << 4
        return seal(0x0A8, word, 2, _TC_FREEZE)

    @classmethod
    def decode(cls, data: bytes) -> "TcFreeze":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            (word & 0xF),
        )


class _CoilStatus(NamedTuple):
    level: int  # level driven in the interval that ends at this tick
    coil: int  # coil driven; while all are off tick modulo 3
    remaining_ms: int  # [ms]; rest of the pulse at this tick
    current_ma: int  # [mA]; read-back of the coil current at this tick
    lockout_ms: int  # [ms]; time until this coil may be fired again, rounded up
    seq: int  # last accepted request
    counter: int = 0


class CoilStatus(_CoilStatus):
    """Exactly one a tick: what was driven in the interval that ends at this tick."""

    __slots__ = ()

    ID: Final = 0x100
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.level & 0xF) << 4
            | (self.coil & 0x3) << 8
            | raw(self.remaining_ms, 1, 0, 4095) << 10
            | (raw(self.current_ma, 1, -2048, 2047) & 0xFFF) << 22
            | raw(self.lockout_ms, 10, 0, 16383) << 34
            | (self.seq & 0xFF) << 48
        )
        return seal(0x100, word, 8, _COIL_STATUS)

    @classmethod
    def decode(cls, data: bytes) -> "CoilStatus":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 4 & 0xF ^ 0x8) - 0x8),
            (word >> 8 & 0x3),
            (word >> 10 & 0xFFF),
            ((word >> 22 & 0xFFF ^ 0x800) - 0x800),
            (word >> 34 & 0x3FFF) * 10,
            (word >> 48 & 0xFF),
            (word & 0xF),
        )


class _CoilDipoleStatus(NamedTuple):
    m_x: float  # [1]
    m_y: float  # [1]
    m_z: float  # [1]
    counter: int = 0


class CoilDipoleStatus(_CoilDipoleStatus):
    """Exactly one a tick from a continuous driver: what was driven in the tick that ends at this tick."""

    __slots__ = ()

    ID: Final = 0x101
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (raw(self.m_x, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 4
            | (raw(self.m_y, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 21
            | (raw(self.m_z, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 38
        )
        return seal(0x101, word, 8, _COIL_DIPOLE_STATUS)

    @classmethod
    def decode(cls, data: bytes) -> "CoilDipoleStatus":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            ((word >> 4 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 21 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 38 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            (word & 0xF),
        )


class _CoilRefused(NamedTuple):
    coil: int
    seq: int  # of the request; of a COIL_DIPOLE its counter
    reason: int
    tick: int  # low 8 bits of the tick in which it came
    counter: int = 0


class CoilRefused(_CoilRefused):
    """A request that was not carried out, and why."""

    __slots__ = ()

    ID: Final = 0x108
    LENGTH: Final = 5

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.coil & 0x3) << 4
            | (self.seq & 0xFF) << 8
            | (self.reason & 0xFF) << 16
            | (self.tick & 0xFF) << 24
        )
        return seal(0x108, word, 5, _COIL_REFUSED)

    @classmethod
    def decode(cls, data: bytes) -> "CoilRefused":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x3),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            (word >> 24 & 0xFF),
            (word & 0xF),
        )


class _MagField(NamedTuple):
    valid: int  # 0 when an axis is saturated or the self-test failed
    b_x: float  # [nT]
    b_y: float  # [nT]
    b_z: float  # [nT]
    counter: int = 0


class MagField(_MagField):
    """Magnetic field in body axes, every tick from tick 0."""

    __slots__ = ()

    ID: Final = 0x110
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.b_x, 2, -32768, 32767) & 0xFFFF) << 8
            | (raw(self.b_y, 2, -32768, 32767) & 0xFFFF) << 24
            | (raw(self.b_z, 2, -32768, 32767) & 0xFFFF) << 40
        )
        return seal(0x110, word, 8, _MAG_FIELD)

    @classmethod
    def decode(cls, data: bytes) -> "MagField":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 8 & 0xFFFF ^ 0x8000) - 0x8000) * 2.0,
            ((word >> 24 & 0xFFFF ^ 0x8000) - 0x8000) * 2.0,
            ((word >> 40 & 0xFFFF ^ 0x8000) - 0x8000) * 2.0,
            (word & 0xF),
        )


class _SunVector(NamedTuple):
    valid: int  # 0 in eclipse or out of view
    s_x: float  # [1]
    s_y: float  # [1]
    s_z: float  # [1]
    counter: int = 0


class SunVector(_SunVector):
    """Unit vector to the Sun in body axes, every tick from tick 0."""

    __slots__ = ()

    ID: Final = 0x118
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.s_x, 6.103515625e-05, -32768, 32767) & 0xFFFF) << 8
            | (raw(self.s_y, 6.103515625e-05, -32768, 32767) & 0xFFFF) << 24
            | (raw(self.s_z, 6.103515625e-05, -32768, 32767) & 0xFFFF) << 40
        )
        return seal(0x118, word, 8, _SUN_VECTOR)

    @classmethod
    def decode(cls, data: bytes) -> "SunVector":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 8 & 0xFFFF ^ 0x8000) - 0x8000) * 6.103515625e-05,
            ((word >> 24 & 0xFFFF ^ 0x8000) - 0x8000) * 6.103515625e-05,
            ((word >> 40 & 0xFFFF ^ 0x8000) - 0x8000) * 6.103515625e-05,
            (word & 0xF),
        )


class _SunCells(NamedTuple):
    valid: int  # 0 when the board failed its self-test
    cell_1: float  # [1]; in parts of the nominal current in full sunlight, as are the others
    cell_2: float  # [1]
    cell_3: float  # [1]
    cell_4: float  # [1]
    cell_5: float  # [1]
    cell_6: float  # [1]
    counter: int = 0


class SunCells(_SunCells):
    """Currents of up to six Sun cells, every tick from tick 0, in place of SUN_VECTOR; 0 where there is no cell."""

    __slots__ = ()

    ID: Final = 0x119
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | raw(self.cell_1, 0.0078125, 0, 255) << 8
            | raw(self.cell_2, 0.0078125, 0, 255) << 16
            | raw(self.cell_3, 0.0078125, 0, 255) << 24
            | raw(self.cell_4, 0.0078125, 0, 255) << 32
            | raw(self.cell_5, 0.0078125, 0, 255) << 40
            | raw(self.cell_6, 0.0078125, 0, 255) << 48
        )
        return seal(0x119, word, 8, _SUN_CELLS)

    @classmethod
    def decode(cls, data: bytes) -> "SunCells":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            (word >> 8 & 0xFF) * 0.0078125,
            (word >> 16 & 0xFF) * 0.0078125,
            (word >> 24 & 0xFF) * 0.0078125,
            (word >> 32 & 0xFF) * 0.0078125,
            (word >> 40 & 0xFF) * 0.0078125,
            (word >> 48 & 0xFF) * 0.0078125,
            (word & 0xF),
        )


class _RefAttitude(NamedTuple):
    valid: int
    q_x: float  # [1]
    q_y: float  # [1]
    q_z: float  # [1]
    counter: int = 0


class RefAttitude(_RefAttitude):
    """True attitude, for scenarios with perfect knowledge: vector part of q_body_from_orbit, scalar part >= 0."""

    __slots__ = ()

    ID: Final = 0x120
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.q_x, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 5
            | (raw(self.q_y, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 22
            | (raw(self.q_z, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 39
        )
        return seal(0x120, word, 8, _REF_ATTITUDE)

    @classmethod
    def decode(cls, data: bytes) -> "RefAttitude":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 5 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 22 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 39 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            (word & 0xF),
        )


class _RefRate(NamedTuple):
    valid: int
    w_x: float  # [rad/s]
    w_y: float  # [rad/s]
    w_z: float  # [rad/s]
    counter: int = 0


class RefRate(_RefRate):
    """True rate, for scenarios with perfect knowledge: omega_body_orbit in body axes."""

    __slots__ = ()

    ID: Final = 0x121
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.w_x, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 5
            | (raw(self.w_y, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 22
            | (raw(self.w_z, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 39
        )
        return seal(0x121, word, 8, _REF_RATE)

    @classmethod
    def decode(cls, data: bytes) -> "RefRate":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 5 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            ((word >> 22 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            ((word >> 39 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            (word & 0xF),
        )


class _WheelStatus(NamedTuple):
    valid: int  # 0 when the speed cannot be measured
    result: int  # what became of the last request in the tick that ends
    speed: float  # [rad/s]; about its axis, relative to the body
    torque: float  # [N m]; that the motor was set to in the tick that ends at this tick
    counter: int = 0


class WheelStatus(_WheelStatus):
    """Exactly one a tick: the speed of the wheel, and its motor torque in the tick that ends."""

    __slots__ = ()

    ID: Final = 0x128
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (self.result & 0x7) << 5
            | (raw(self.speed, 0.000244140625, -8388608, 8388607) & 0xFFFFFF) << 8
            | (raw(self.torque, 5.960464477539063e-08, -8388608, 8388607) & 0xFFFFFF) << 32
        )
        return seal(0x128, word, 8, _WHEEL_STATUS)

    @classmethod
    def decode(cls, data: bytes) -> "WheelStatus":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            (word >> 5 & 0x7),
            ((word >> 8 & 0xFFFFFF ^ 0x800000) - 0x800000) * 0.000244140625,
            ((word >> 32 & 0xFFFFFF ^ 0x800000) - 0x800000) * 5.960464477539063e-08,
            (word & 0xF),
        )


class _Sync(NamedTuple):
    tick: int
    unix_time_s: int  # [s]


class Sync(_Sync):
    """Ends the inbox of a tick. unix_time_s = epoch + tick // tick_hz."""

    __slots__ = ()

    ID: Final = 0x180
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.tick & 0xFFFFFFFF) | raw(self.unix_time_s, 1, 0, 4294967295) << 32
        return Frame(0x180, word.to_bytes(8, "little"))

    @classmethod
    def decode(cls, data: bytes) -> "Sync":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word & 0xFFFFFFFF),
            (word >> 32 & 0xFFFFFFFF),
        )


class _NavAttitude(NamedTuple):
    valid: int
    q_x: float  # [1]
    q_y: float  # [1]
    q_z: float  # [1]
    counter: int = 0


class NavAttitude(_NavAttitude):
    """Estimated attitude: vector part of q_body_from_orbit, scalar part >= 0."""

    __slots__ = ()

    ID: Final = 0x200
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.q_x, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 5
            | (raw(self.q_y, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 22
            | (raw(self.q_z, 1.52587890625e-05, -65536, 65535) & 0x1FFFF) << 39
        )
        return seal(0x200, word, 8, _NAV_ATTITUDE)

    @classmethod
    def decode(cls, data: bytes) -> "NavAttitude":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 5 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 22 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            ((word >> 39 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.52587890625e-05,
            (word & 0xF),
        )


class _NavRate(NamedTuple):
    valid: int
    w_x: float  # [rad/s]
    w_y: float  # [rad/s]
    w_z: float  # [rad/s]
    counter: int = 0


class NavRate(_NavRate):
    """Estimated rate: omega_body_orbit in body axes."""

    __slots__ = ()

    ID: Final = 0x201
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.valid & 0x1) << 4
            | (raw(self.w_x, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 5
            | (raw(self.w_y, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 22
            | (raw(self.w_z, 1.9073486328125e-06, -65536, 65535) & 0x1FFFF) << 39
        )
        return seal(0x201, word, 8, _NAV_RATE)

    @classmethod
    def decode(cls, data: bytes) -> "NavRate":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x1),
            ((word >> 5 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            ((word >> 22 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            ((word >> 39 & 0x1FFFF ^ 0x10000) - 0x10000) * 1.9073486328125e-06,
            (word & 0xF),
        )


class _NavQuality(NamedTuple):
    mode: int
    sigma3_attitude: float  # [rad]
    sigma3_rate: float  # [rad/s]
    mag_used: int
    sun_used: int
    mag_blanked: int
    eclipse: int
    estimate_valid: int
    tripped: int  # a monitor has tripped since boot or TC_CLEAR
    trips: int  # monitor trips since boot or TC_CLEAR, at most 255
    counter: int = 0


class NavQuality(_NavQuality):
    """Three sigma of the estimate (largest axis), mode and flags."""

    __slots__ = ()

    ID: Final = 0x202
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.mode & 0x7) << 4
            | raw(self.sigma3_attitude, 6.103515625e-05, 0, 65535) << 8
            | raw(self.sigma3_rate, 2.384185791015625e-07, 0, 65535) << 24
            | (self.mag_used & 0x1) << 40
            | (self.sun_used & 0x1) << 41
            | (self.mag_blanked & 0x1) << 42
            | (self.eclipse & 0x1) << 43
            | (self.estimate_valid & 0x1) << 44
            | (self.tripped & 0x1) << 45
            | (self.trips & 0xFF) << 48
        )
        return seal(0x202, word, 8, _NAV_QUALITY)

    @classmethod
    def decode(cls, data: bytes) -> "NavQuality":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x7),
            (word >> 8 & 0xFFFF) * 6.103515625e-05,
            (word >> 24 & 0xFFFF) * 2.384185791015625e-07,
            (word >> 40 & 0x1),
            (word >> 41 & 0x1),
            (word >> 42 & 0x1),
            (word >> 43 & 0x1),
            (word >> 44 & 0x1),
            (word >> 45 & 0x1),
            (word >> 48 & 0xFF),
            (word & 0xF),
        )


class _NavParameter(NamedTuple):
    component: int  # axes are those of the body; of the coils row and column of G, dipole = (1 + G) times the one driven
    exponent: int
    value: int  # times 10^exponent
    sigma: int  # standard deviation, times 10^exponent
    counter: int = 0


class NavParameter(_NavParameter):
    """One of the numbers that the filter estimates besides attitude and rate, each in its turn; SI units."""

    __slots__ = ()

    ID: Final = 0x203
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.component & 0x3F) << 4
            | (self.exponent & 0xFF) << 10
            | (self.value & 0x7FFFF) << 18
            | (self.sigma & 0x7FFFF) << 37
        )
        return seal(0x203, word, 8, _NAV_PARAMETER)

    @classmethod
    def decode(cls, data: bytes) -> "NavParameter":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0x3F),
            ((word >> 10 & 0xFF ^ 0x80) - 0x80),
            ((word >> 18 & 0x7FFFF ^ 0x40000) - 0x40000),
            (word >> 37 & 0x7FFFF),
            (word & 0xF),
        )


class _TcAck(NamedTuple):
    result: int
    command: int  # identifier of the telecommand
    command_counter: int  # counter of the telecommand
    tick: int  # tick that is answered
    counter: int = 0


class TcAck(_TcAck):
    """What became of a telecommand: one for each that came intact."""

    __slots__ = ()

    ID: Final = 0x208
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.result & 0xF) << 4
            | (self.command & 0x7FF) << 8
            | (self.command_counter & 0xF) << 19
            | (self.tick & 0xFFFFFFFF) << 24
        )
        return seal(0x208, word, 8, _TC_ACK)

    @classmethod
    def decode(cls, data: bytes) -> "TcAck":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0x7FF),
            (word >> 19 & 0xF),
            (word >> 24 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _TickDone(NamedTuple):
    tick: int
    state_crc: int


class TickDone(_TickDone):
    """Last frame of fsw's answer to a tick. state_crc: CRC-32 of the whole flight state after this tick."""

    __slots__ = ()

    ID: Final = 0x280
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.tick & 0xFFFFFFFF) | (self.state_crc & 0xFFFFFFFF) << 32
        return Frame(0x280, word.to_bytes(8, "little"))

    @classmethod
    def decode(cls, data: bytes) -> "TickDone":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word & 0xFFFFFFFF),
            (word >> 32 & 0xFFFFFFFF),
        )


class _PlantEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int
    counter: int = 0


class PlantEvent(_PlantEvent):
    """Something worth knowing happened in PLANT."""

    __slots__ = ()

    ID: Final = 0x400
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x400, word, 8, _PLANT_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "PlantEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _FswEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int  # what the event tells of; a tick as it is, from 2^31 on less 2^32
    counter: int = 0


class FswEvent(_FswEvent):
    """Something worth knowing happened in FSW."""

    __slots__ = ()

    ID: Final = 0x410
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x410, word, 8, _FSW_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "FswEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _CoilEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int  # of what concerns the current: the read-back in mA
    counter: int = 0


class CoilEvent(_CoilEvent):
    """Something worth knowing happened in COIL."""

    __slots__ = ()

    ID: Final = 0x420
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x420, word, 8, _COIL_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "CoilEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _MagEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int
    counter: int = 0


class MagEvent(_MagEvent):
    """Something worth knowing happened in MAG."""

    __slots__ = ()

    ID: Final = 0x430
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x430, word, 8, _MAG_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "MagEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _SunEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int
    counter: int = 0


class SunEvent(_SunEvent):
    """Something worth knowing happened in SUN."""

    __slots__ = ()

    ID: Final = 0x440
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x440, word, 8, _SUN_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "SunEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _WheelEvent(NamedTuple):
    severity: int
    event: int  # number of the event in this node's list
    tick: int  # low 8 bits of the tick
    argument: int
    counter: int = 0


class WheelEvent(_WheelEvent):
    """Something worth knowing happened in WHEEL."""

    __slots__ = ()

    ID: Final = 0x450
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.severity & 0xF) << 4
            | (self.event & 0xFF) << 8
            | (self.tick & 0xFF) << 16
            | (self.argument & 0xFFFFFFFF) << 24
        )
        return seal(0x450, word, 8, _WHEEL_EVENT)

    @classmethod
    def decode(cls, data: bytes) -> "WheelEvent":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFF),
            ((word >> 24 & 0xFFFFFFFF ^ 0x80000000) - 0x80000000),
            (word & 0xF),
        )


class _PlantBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class PlantBoot(_PlantBoot):
    """PLANT has started."""

    __slots__ = ()

    ID: Final = 0x500
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x500, word, 7, _PLANT_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "PlantBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _FswBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class FswBoot(_FswBoot):
    """FSW has started."""

    __slots__ = ()

    ID: Final = 0x510
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x510, word, 7, _FSW_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "FswBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _CoilBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class CoilBoot(_CoilBoot):
    """COIL has started."""

    __slots__ = ()

    ID: Final = 0x520
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x520, word, 7, _COIL_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "CoilBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _MagBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class MagBoot(_MagBoot):
    """MAG has started."""

    __slots__ = ()

    ID: Final = 0x530
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x530, word, 7, _MAG_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "MagBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _SunBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class SunBoot(_SunBoot):
    """SUN has started."""

    __slots__ = ()

    ID: Final = 0x540
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x540, word, 7, _SUN_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "SunBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _WheelBoot(NamedTuple):
    reason: int
    version: int  # version of this bus contract
    table_crc: int  # CRC-32 of the node's table
    counter: int = 0


class WheelBoot(_WheelBoot):
    """WHEEL has started."""

    __slots__ = ()

    ID: Final = 0x550
    LENGTH: Final = 7

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.reason & 0xF) << 4
            | (self.version & 0xFF) << 8
            | (self.table_crc & 0xFFFFFFFF) << 16
        )
        return seal(0x550, word, 7, _WHEEL_BOOT)

    @classmethod
    def decode(cls, data: bytes) -> "WheelBoot":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFF),
            (word >> 16 & 0xFFFFFFFF),
            (word & 0xF),
        )


class _PlantHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class PlantHeartbeat(_PlantHeartbeat):
    """PLANT is alive."""

    __slots__ = ()

    ID: Final = 0x600
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x600, word, 8, _PLANT_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "PlantHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _FswHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class FswHeartbeat(_FswHeartbeat):
    """FSW is alive."""

    __slots__ = ()

    ID: Final = 0x610
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x610, word, 8, _FSW_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "FswHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _CoilHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class CoilHeartbeat(_CoilHeartbeat):
    """COIL is alive."""

    __slots__ = ()

    ID: Final = 0x620
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x620, word, 8, _COIL_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "CoilHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _MagHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class MagHeartbeat(_MagHeartbeat):
    """MAG is alive."""

    __slots__ = ()

    ID: Final = 0x630
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x630, word, 8, _MAG_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "MagHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _SunHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class SunHeartbeat(_SunHeartbeat):
    """SUN is alive."""

    __slots__ = ()

    ID: Final = 0x640
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x640, word, 8, _SUN_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "SunHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _WheelHeartbeat(NamedTuple):
    state: int
    rejects: int  # frames rejected since boot, at most 65535
    slips: int  # missed deadlines since boot, at most 65535
    tick: int  # low 16 bits of the tick
    counter: int = 0


class WheelHeartbeat(_WheelHeartbeat):
    """WHEEL is alive."""

    __slots__ = ()

    ID: Final = 0x650
    LENGTH: Final = 8

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (
            (self.counter & 0xF)
            | (self.state & 0xF) << 4
            | (self.rejects & 0xFFFF) << 8
            | (self.slips & 0xFFFF) << 24
            | (self.tick & 0xFFFF) << 40
        )
        return seal(0x650, word, 8, _WHEEL_HEARTBEAT)

    @classmethod
    def decode(cls, data: bytes) -> "WheelHeartbeat":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 4 & 0xF),
            (word >> 8 & 0xFFFF),
            (word >> 24 & 0xFFFF),
            (word >> 40 & 0xFFFF),
            (word & 0xF),
        )


class _PlantEnd(NamedTuple):
    ticks: int  # ticks flown, modulo 2^24
    counter: int = 0


class PlantEnd(_PlantEnd):
    """The run is over: last frame of a complete log."""

    __slots__ = ()

    ID: Final = 0x700
    LENGTH: Final = 5

    def encode(self) -> Frame:
        """The frame on the bus."""
        word = (self.counter & 0xF) | (self.ticks & 0xFFFFFF) << 8
        return seal(0x700, word, 5, _PLANT_END)

    @classmethod
    def decode(cls, data: bytes) -> "PlantEnd":
        """The values in the data bytes, unjudged."""
        word = int.from_bytes(data, "little")
        return cls(
            (word >> 8 & 0xFFFFFF),
            (word & 0xF),
        )


CountedMessage = (
    CoilFire
    | CoilDipole
    | WheelTorque
    | TcMode
    | TcClear
    | TcLaw
    | TcSpin
    | TcGain
    | TcOrbitElement
    | TcOrbitLoad
    | TcParameter
    | TcFreeze
    | CoilStatus
    | CoilDipoleStatus
    | CoilRefused
    | MagField
    | SunVector
    | SunCells
    | RefAttitude
    | RefRate
    | WheelStatus
    | NavAttitude
    | NavRate
    | NavQuality
    | NavParameter
    | TcAck
    | PlantEvent
    | FswEvent
    | CoilEvent
    | MagEvent
    | SunEvent
    | WheelEvent
    | PlantBoot
    | FswBoot
    | CoilBoot
    | MagBoot
    | SunBoot
    | WheelBoot
    | PlantHeartbeat
    | FswHeartbeat
    | CoilHeartbeat
    | MagHeartbeat
    | SunHeartbeat
    | WheelHeartbeat
    | PlantEnd
)

AnyMessage = CountedMessage | Sync | TickDone

CLASSES: dict[int, type[AnyMessage]] = {
    0x080: CoilFire,
    0x088: CoilDipole,
    0x090: WheelTorque,
    0x0A0: TcMode,
    0x0A1: TcClear,
    0x0A2: TcLaw,
    0x0A3: TcSpin,
    0x0A4: TcGain,
    0x0A5: TcOrbitElement,
    0x0A6: TcOrbitLoad,
    0x0A7: TcParameter,
    0x0A8: TcFreeze,
    0x100: CoilStatus,
    0x101: CoilDipoleStatus,
    0x108: CoilRefused,
    0x110: MagField,
    0x118: SunVector,
    0x119: SunCells,
    0x120: RefAttitude,
    0x121: RefRate,
    0x128: WheelStatus,
    0x180: Sync,
    0x200: NavAttitude,
    0x201: NavRate,
    0x202: NavQuality,
    0x203: NavParameter,
    0x208: TcAck,
    0x280: TickDone,
    0x400: PlantEvent,
    0x410: FswEvent,
    0x420: CoilEvent,
    0x430: MagEvent,
    0x440: SunEvent,
    0x450: WheelEvent,
    0x500: PlantBoot,
    0x510: FswBoot,
    0x520: CoilBoot,
    0x530: MagBoot,
    0x540: SunBoot,
    0x550: WheelBoot,
    0x600: PlantHeartbeat,
    0x610: FswHeartbeat,
    0x620: CoilHeartbeat,
    0x630: MagHeartbeat,
    0x640: SunHeartbeat,
    0x650: WheelHeartbeat,
    0x700: PlantEnd,
}
"""Class of each message."""

NAMES: dict[int, str] = {
    0x080: "COIL_FIRE",
    0x088: "COIL_DIPOLE",
    0x090: "WHEEL_TORQUE",
    0x0A0: "TC_MODE",
    0x0A1: "TC_CLEAR",
    0x0A2: "TC_LAW",
    0x0A3: "TC_SPIN",
    0x0A4: "TC_GAIN",
    0x0A5: "TC_ORBIT_ELEMENT",
    0x0A6: "TC_ORBIT_LOAD",
    0x0A7: "TC_PARAMETER",
    0x0A8: "TC_FREEZE",
    0x100: "COIL_STATUS",
    0x101: "COIL_DIPOLE_STATUS",
    0x108: "COIL_REFUSED",
    0x110: "MAG_FIELD",
    0x118: "SUN_VECTOR",
    0x119: "SUN_CELLS",
    0x120: "REF_ATTITUDE",
    0x121: "REF_RATE",
    0x128: "WHEEL_STATUS",
    0x180: "SYNC",
    0x200: "NAV_ATTITUDE",
    0x201: "NAV_RATE",
    0x202: "NAV_QUALITY",
    0x203: "NAV_PARAMETER",
    0x208: "TC_ACK",
    0x280: "TICK_DONE",
    0x400: "PLANT_EVENT",
    0x410: "FSW_EVENT",
    0x420: "COIL_EVENT",
    0x430: "MAG_EVENT",
    0x440: "SUN_EVENT",
    0x450: "WHEEL_EVENT",
    0x500: "PLANT_BOOT",
    0x510: "FSW_BOOT",
    0x520: "COIL_BOOT",
    0x530: "MAG_BOOT",
    0x540: "SUN_BOOT",
    0x550: "WHEEL_BOOT",
    0x600: "PLANT_HEARTBEAT",
    0x610: "FSW_HEARTBEAT",
    0x620: "COIL_HEARTBEAT",
    0x630: "MAG_HEARTBEAT",
    0x640: "SUN_HEARTBEAT",
    0x650: "WHEEL_HEARTBEAT",
    0x700: "PLANT_END",
}
"""Name of each message in the DBC."""

SENDERS: dict[int, str] = {
    0x080: "FSW",
    0x088: "FSW",
    0x090: "FSW",
    0x0A0: "GROUND",
    0x0A1: "GROUND",
    0x0A2: "GROUND",
    0x0A3: "GROUND",
    0x0A4: "GROUND",
    0x0A5: "GROUND",
    0x0A6: "GROUND",
    0x0A7: "GROUND",
    0x0A8: "GROUND",
    0x100: "COIL",
    0x101: "COIL",
    0x108: "COIL",
    0x110: "MAG",
    0x118: "SUN",
    0x119: "SUN",
    0x120: "PLANT",
    0x121: "PLANT",
    0x128: "WHEEL",
    0x180: "PLANT",
    0x200: "FSW",
    0x201: "FSW",
    0x202: "FSW",
    0x203: "FSW",
    0x208: "FSW",
    0x280: "FSW",
    0x400: "PLANT",
    0x410: "FSW",
    0x420: "COIL",
    0x430: "MAG",
    0x440: "SUN",
    0x450: "WHEEL",
    0x500: "PLANT",
    0x510: "FSW",
    0x520: "COIL",
    0x530: "MAG",
    0x540: "SUN",
    0x550: "WHEEL",
    0x600: "PLANT",
    0x610: "FSW",
    0x620: "COIL",
    0x630: "MAG",
    0x640: "SUN",
    0x650: "WHEEL",
    0x700: "PLANT",
}
"""Node that sends each message."""

_SHAPES: dict[int, tuple[int, int | None]] = {
    0x080: (7, _COIL_FIRE),
    0x088: (8, _COIL_DIPOLE),
    0x090: (6, _WHEEL_TORQUE),
    0x0A0: (2, _TC_MODE),
    0x0A1: (2, _TC_CLEAR),
    0x0A2: (3, _TC_LAW),
    0x0A3: (4, _TC_SPIN),
    0x0A4: (7, _TC_GAIN),
    0x0A5: (7, _TC_ORBIT_ELEMENT),
    0x0A6: (2, _TC_ORBIT_LOAD),
    0x0A7: (8, _TC_PARAMETER),
    0x0A8: (2, _TC_FREEZE),
    0x100: (8, _COIL_STATUS),
    0x101: (8, _COIL_DIPOLE_STATUS),
    0x108: (5, _COIL_REFUSED),
    0x110: (8, _MAG_FIELD),
    0x118: (8, _SUN_VECTOR),
    0x119: (8, _SUN_CELLS),
    0x120: (8, _REF_ATTITUDE),
    0x121: (8, _REF_RATE),
    0x128: (8, _WHEEL_STATUS),
    0x180: (8, None),
    0x200: (8, _NAV_ATTITUDE),
    0x201: (8, _NAV_RATE),
    0x202: (8, _NAV_QUALITY),
    0x203: (8, _NAV_PARAMETER),
    0x208: (8, _TC_ACK),
    0x280: (8, None),
    0x400: (8, _PLANT_EVENT),
    0x410: (8, _FSW_EVENT),
    0x420: (8, _COIL_EVENT),
    0x430: (8, _MAG_EVENT),
    0x440: (8, _SUN_EVENT),
    0x450: (8, _WHEEL_EVENT),
    0x500: (7, _PLANT_BOOT),
    0x510: (7, _FSW_BOOT),
    0x520: (7, _COIL_BOOT),
    0x530: (7, _MAG_BOOT),
    0x540: (7, _SUN_BOOT),
    0x550: (7, _WHEEL_BOOT),
    0x600: (8, _PLANT_HEARTBEAT),
    0x610: (8, _FSW_HEARTBEAT),
    0x620: (8, _COIL_HEARTBEAT),
    0x630: (8, _MAG_HEARTBEAT),
    0x640: (8, _SUN_HEARTBEAT),
    0x650: (8, _WHEEL_HEARTBEAT),
    0x700: (5, _PLANT_END),
}


def intact(frame: Frame) -> bool:
    """Whether the frame is a known message of the right length whose CRC, if it has one, is right."""
    shape = _SHAPES.get(frame.can_id)
    if shape is None:
        return False
    length, register = shape
    data = frame.data
    if len(data) != length:
        return False
    return register is None or crc8(data[:-1], register) == data[-1]
