"""PD law without a measured rate: a filter that follows the attitude gives it.

The filter is z' = a (q - z). Where the motion is slow against a its lag q - z is q' / a, and as
q' = 1/2 W(q) Omega with W^T W = E,

    Omega ~ 2 a W(q)^T (q - z),     W(q)^T y = q0 yv - y0 qv - qv x yv.

The dipole is m = -k_w b x Omega_z - k_a b x E, E = 4 qv.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Lovera, Astolfi 2004: delta' = alpha (q - eps lambda
delta), u = -eps^2 (k1 q + k2 alpha lambda W^T (q - eps lambda delta)). The scan damages it; here
z = eps lambda delta, a = alpha eps lambda, and the gains are those of the PD law.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import Vec3, cross
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import far_error, pd_dipole

MAX_BANDWIDTH_RADPS = 100.0


@dataclass(frozen=True, slots=True)
class FilterGains:
    """The filter's bandwidth a, rad/s: well above the orbit's rate, well under the sensors' noise."""

    bandwidth_radps: float = 0.02

    def __post_init__(self) -> None:
        """Raises ValueError: a filter that does not follow."""
        if not 0.0 < self.bandwidth_radps <= MAX_BANDWIDTH_RADPS:
            raise ValueError(f"bandwidth_radps must be above 0 and at most {MAX_BANDWIDTH_RADPS:g}")


def lagged_rate(q_body_from_orbit: Quaternion, followed: Quaternion, bandwidth_radps: float) -> Vec3:
    """Omega_z = 2 a W(q)^T (q - z), body axes, rad/s: the rate, low-passed at a.

    Args:
        q_body_from_orbit: q, the attitude now.
        followed: z, the filter's state, of z and -z the one nearer to q.
        bandwidth_radps: a.
    """
    q0, q1, q2, q3 = q_body_from_orbit
    z0, z1, z2, z3 = followed
    y0, y1, y2, y3 = q0 - z0, q1 - z1, q2 - z2, q3 - z3
    c1, c2, c3 = cross((q1, q2, q3), (y1, y2, y3))
    factor = 2.0 * bandwidth_radps
    return (
        factor * (q0 * y1 - y0 * q1 - c1),
        factor * (q0 * y2 - y0 * q2 - c2),
        factor * (q0 * y3 - y0 * q3 - c3),
    )


def nearer_sign(z: Quaternion, q: Quaternion) -> Quaternion:
    """Of z and -z, which are the same attitude, the one nearer to q."""
    near = z[0] * q[0] + z[1] * q[1] + z[2] * q[2] + z[3] * q[3] >= 0.0
    return z if near else (-z[0], -z[1], -z[2], -z[3])


def follow(q_body_from_orbit: Quaternion, followed: Quaternion, part: float) -> Quaternion:
    """The filter's next state, z + part (q - z), ``part`` from 0 to 1."""
    q0, q1, q2, q3 = q_body_from_orbit
    z0, z1, z2, z3 = followed
    return (z0 + part * (q0 - z0), z1 + part * (q1 - z1), z2 + part * (q2 - z2), z3 + part * (q3 - z3))


def output_feedback(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The PD law on the lagged rate; memory is z, which begins at the first usable attitude."""
    if not inputs.attitude.usable:
        return Demand()
    q = inputs.attitude.q_body_from_orbit
    gains: FilterGains = config.gains["output_feedback"]
    z = q
    if len(memory) == 4:
        z0, z1, z2, z3 = memory
        z = nearer_sign((z0, z1, z2, z3), q)
    omega = lagged_rate(q, z, gains.bandwidth_radps)
    step = gains.bandwidth_radps * config.tick_s
    dipole = pd_dipole(inputs.b_body_t, omega, far_error(q), setpoint.k_w, setpoint.k_a)
    return Demand(dipole, memory=follow(q, z, step / (1.0 + step)))


LAWS = {
    "output_feedback": LawEntry(52, Aim.THREE_AXIS, output_feedback, output_feedback, FilterGains),
}
