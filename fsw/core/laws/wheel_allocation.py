"""Torque shared between coils and wheels with the least effort.

Only a wheel can give the component of a torque along the field. With one wheel and the whole torque given,
its momentum is therefore not free: a lasting torque about its axis saturates it. Coils that unload it turn
the body, as in ``pitch_wheel``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from fsw.core.algebra.vector import Mat3, Vec3, cross, dot, inverse, norm, scale, transform
from fsw.core.laws.entry import Aim, LawEntry, Need
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.wheel_effort import Effort, check_frequency, compensated_torque, shortened

LEAST_DETERMINANT = 1e-15
"""Of the matrix scaled to a trace of one, below which it counts as singular."""
MOST_RATIO = 100.0
"""Full torque of the wheel over that of the coils across the field, from which the effort counts no more."""
FLOORS = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Values of the floor, as fractions of the torque that the coils can give across the field."""


@dataclass(frozen=True, slots=True)
class AllocationGains:
    """How fast the attitude is restored.

    Attributes:
        frequency_radps: natural frequency, rad/s.
        damping: damping ratio.
    """

    frequency_radps: float = 0.01
    damping: float = 1.0

    def __post_init__(self) -> None:
        """Check them.

        Raises:
            ValueError: one is out of range.
        """
        check_frequency(self.frequency_radps, self.damping)


class Shares(NamedTuple):
    """A dipole, body axes, A m^2, and the torque on each wheel about its axis, N m."""

    m_body_am2: Vec3
    wheel_torques_nm: tuple[float, ...]


def least_effort(
    torque_body_nm: Vec3,
    b_body_t: Vec3,
    axes_body: Sequence[Vec3],
    most_am2: float,
    most_nm: Sequence[float],
    floor_nm: float = 0.0,
) -> Shares | None:
    """The shares u = (m, p) with the least |m / M|^2 + sum (p_i / P_i)^2, m x b + sum p_i w_i being T.

    G u = T, G = (-[b x], w_1 .. w_n), R = diag(1/M^2, 1/P_i^2):

        u = R^-1 G^T (G R^-1 G^T + e^2 E)^-1 T,      G R^-1 G^T = M^2 (|b|^2 E - b b^T) + sum P_i^2 w_i w_i^T

    With e = 0 the whole torque is given, wherever the wheels together reach along b; e > 0 weighs what is
    left of it against the effort, (|T - G u| / e)^2, so that nothing grows without bound as the wheels become
    normal to b. Without a wheel it is the dipole of the projected torque. The torque on a wheel is -p_i.

    Args:
        torque_body_nm: T, body axes.
        b_body_t: b, body axes, T.
        axes_body: w_i, unit, body axes; any number of wheels.
        most_am2: M, dipole that counts as full effort.
        most_nm: P_i, by wheel, the torque that counts as full effort.
        floor_nm: e.

    Returns:
        The shares, None where the matrix is singular.

    Source: wheels and coils by projection along and across the field, Forbes, Damaren 2010, as in
    Ovchinnikov, Roldugin 2019, section 2.4 [57], which gives no equation; the weighted least squares and its
    floor are derived here.
    """
    square = most_am2**2
    weighted = [[-square * b * c for c in b_body_t] for b in b_body_t]
    for axis, most in zip(axes_body, most_nm, strict=True):
        for row, a in zip(weighted, axis, strict=True):
            row[:] = [value + most**2 * a * c for value, c in zip(row, axis, strict=True)]
    for place in range(3):
        weighted[place][place] += square * dot(b_body_t, b_body_t) + floor_nm**2
    first, second, third = ((x, y, z) for x, y, z in weighted)
    price = _solved((first, second, third), torque_body_nm)
    if price is None:
        return None
    m = scale(square, cross(b_body_t, price))
    pairs = zip(axes_body, most_nm, strict=True)
    return Shares(m, tuple(-(most**2) * dot(axis, price) for axis, most in pairs))


def _solved(matrix: Mat3, right: Vec3) -> Vec3 | None:
    """The solution of a symmetric system that, scaled by its own size, is not nearly singular."""
    size = matrix[0][0] + matrix[1][1] + matrix[2][2]
    if not size > 0.0:
        return None
    a, b, c = (scale(1.0 / size, row) for row in matrix)
    if dot(a, cross(b, c)) < LEAST_DETERMINANT:
        return None
    return scale(1.0 / size, transform(inverse((a, b, c)), right))


def affordable(
    torque_body_nm: Vec3, b_body_t: Vec3, axis_body: Vec3, most_am2: float, most_nm: float
) -> Effort | None:
    """The least effort of coils and one wheel, the whole torque if they can give it.

    If they cannot, the floor rises through ``FLOORS`` until they can: what costs most, the torque along a
    field nearly normal to the wheel, is given up first. What even the highest floor leaves too large is
    scaled down. None without a field. In the effort a wheel counts as at most
    ``MOST_RATIO`` times stronger than the coils: beyond that the matrix becomes singular.

    Args:
        torque_body_nm: T, body axes.
        b_body_t: b, body axes, T.
        axis_body: w, unit, body axes.
        most_am2: largest dipole.
        most_nm: largest torque on the wheel.
    """
    most_across_nm = most_am2 * norm(b_body_t)
    full_nm = min(most_nm, MOST_RATIO * most_across_nm)
    effort = None
    for floor in (0.0, *FLOORS):
        shares = least_effort(
            torque_body_nm, b_body_t, (axis_body,), most_am2, (full_nm,), floor * most_across_nm
        )
        if shares is None:
            continue
        effort = Effort(shares.m_body_am2, shares.wheel_torques_nm[0])
        if norm(effort.m_body_am2) <= most_am2 and abs(effort.wheel_torque_nm) <= most_nm:
            return effort
    return None if effort is None else shortened(effort, most_am2, most_nm)


def wheel_allocation(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The torque wanted, by three coils and the wheel with the least effort.

    Without a wheel whose momentum is known, or without a field, nothing.
    """
    gains: AllocationGains = config.gains["wheel_allocation"]
    wheel = config.wheel
    if wheel is None or inputs.wheel_nms is None or not inputs.attitude.usable:
        return Demand()
    wanted = compensated_torque(inputs, config, gains.frequency_radps, gains.damping)
    b, axis, most_am2, most_nm = inputs.b_body_t, wheel.axis_body, config.mean_dipole_am2, wheel.max_torque_nm
    effort = affordable(wanted, b, axis, most_am2, most_nm)
    if effort is None:
        return Demand()
    return Demand(effort.m_body_am2, wheel_torque_nm=effort.wheel_torque_nm)


LAWS = {
    "wheel_allocation": LawEntry(
        121, Aim.THREE_AXIS, wheel_allocation, wheel_allocation, AllocationGains, needs=Need.DRIVEN_WHEEL
    ),
}
