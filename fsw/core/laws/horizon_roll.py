"""Roll of a horizon sensor as the only measurement of a satellite with a pitch wheel near the equator."""

from dataclasses import dataclass
from math import atan2, exp, pi, remainder

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Mat3, Vec3
from fsw.core.laws.damping import MAX_DIFFERENCE_S
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.roll_yaw import can_hold


@dataclass(frozen=True, slots=True)
class HorizonRollGains:
    """Bandwidth of the filter that gives the roll rate, rad/s; above the nutation frequency."""

    bandwidth_radps: float = 0.2

    def __post_init__(self) -> None:
        """Check the range.

        Raises:
            ValueError: the bandwidth is out of range.
        """
        if not 1e-4 <= self.bandwidth_radps <= 100.0:
            raise ValueError(f"bandwidth_radps must be 1e-4 to 100, not {self.bandwidth_radps:g}")


def horizon_roll_angle(c_body_from_orbit: Mat3) -> float:
    """What a horizon sensor shows about axis 2, rad: atan2(e1_3, e1_1) of the vertical e1 in body axes."""
    (a11, _, _), _, (a31, _, _) = c_body_from_orbit
    return atan2(a31, a11)


def horizon_dipole(b_body_t: Vec3, roll: float, roll_rate: float, k_w: float, k_a: float) -> Vec3:
    """(m1, m2) = b3 (k_w roll', -2 k_a roll), from roll alone.

    The field near the equator is along the wheel, where the coil along it is of no use. The torques are
    T1 = -2 k_a b3^2 roll, which turns the momentum back as h (roll' + w0 yaw) = T1, and T2 = -k_w b3^2 roll',
    a damping of the nutation. Yaw needs no sensor: a quarter of an orbit later it is roll. Slow motion obeys

        roll'' + (2 k_a + w0 k_w) (b3^2 / h) roll' + w0^2 roll = 0.

    T1 drives the nutation, and the damping outweighs it where k_w h > 2 k_a J2 (Routh; J2 the moment about
    axis 2, small compared with h / w0). Pitch is left to gravity gradient and wheel.

    Args:
        b_body_t: field in body axes, T.
        roll: turn about axis 2, rad.
        roll_rate: its derivative, rad/s.
        k_w: N m s / T^2.
        k_a: N m / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Goel, Rajaram 1979, of whom Ovchinnikov, Roldugin 2019, section 2.2, says that the data of an
    infrared horizon sensor replace the magnetometer's; their equation is not given there, this one is
    derived for their near-equatorial orbit.
    """
    b3 = b_body_t[2]
    return (k_w * b3 * roll_rate, -2.0 * k_a * b3 * roll, 0.0)


def filtered(
    roll: float, before: tuple[float, float], elapsed_s: float, bandwidth_radps: float
) -> tuple[float, float]:
    """Roll and its rate by the fading-memory filter, from those of ``before``, ``elapsed_s`` ago.

    With p = exp(-bandwidth elapsed) the residual e of the predicted roll corrects the roll by (1 - p^2) e and
    the rate by (1 - p)^2 e / elapsed. Residual and roll are wrapped to +-pi.

    Source: Morrison 1969, the fading-memory polynomial filter of degree one.
    """
    old, rate = before
    p = exp(-bandwidth_radps * elapsed_s)
    ahead = old + rate * elapsed_s
    residual = wrapped(roll - ahead)
    return wrapped(ahead + (1.0 - p * p) * residual), rate + (1.0 - p) ** 2 * residual / elapsed_s


def wrapped(angle_rad: float) -> float:
    """The same angle, from -pi to pi."""
    return remainder(angle_rad, 2.0 * pi)


def horizon_roll(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The law from the roll of the attitude, in place of the sensor's. Memory: tick, roll, roll rate.

    The first sample gives no dipole, nor does one long after the last.
    """
    if not can_hold(inputs, config):
        return Demand()
    gains: HorizonRollGains = config.gains["horizon_roll"]
    shown = horizon_roll_angle(dcm(inputs.attitude.q_body_from_orbit))
    begun = Demand(memory=(float(inputs.tick), shown, 0.0))
    if not memory:
        return begun
    elapsed_s = (inputs.tick - memory[0]) * config.tick_s
    if elapsed_s > MAX_DIFFERENCE_S:
        return begun
    roll, rate = memory[1], memory[2]
    if elapsed_s > 0.0:
        roll, rate = filtered(shown, (roll, rate), elapsed_s, gains.bandwidth_radps)
    dipole = horizon_dipole(inputs.b_body_t, roll, rate, setpoint.k_w, setpoint.k_a)
    return Demand(dipole, memory=(float(inputs.tick), roll, rate))


LAWS = {
    "horizon_roll": LawEntry(23, Aim.AXIS, horizon_roll, horizon_roll, HorizonRollGains, needs=Need.MOMENTUM),
}
