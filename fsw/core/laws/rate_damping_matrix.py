"""Damping with a matrix for a gain: each coil as strong as its axis needs."""

from dataclasses import dataclass

from fsw.core.algebra.vector import Mat3, Vec3, cross, positive_definite, scale, transform
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint


@dataclass(frozen=True, slots=True)
class MatrixGains:
    """H of the law, symmetric, in units of k_w.

    Raises:
        ValueError: H is not positive definite, so that some rate would not be damped.
    """

    h11: float = 1.5
    h22: float = 1.0
    h33: float = 1.0
    h12: float = 0.0
    h13: float = 0.0
    h23: float = 0.0

    def __post_init__(self) -> None:
        if not positive_definite(self.matrix):
            raise ValueError("the matrix h11 to h23 of the gain is not positive definite")

    @property
    def matrix(self) -> Mat3:
        """H, dimensionless."""
        return (
            (self.h11, self.h12, self.h13),
            (self.h12, self.h22, self.h23),
            (self.h13, self.h23, self.h33),
        )


def matrix_damping_dipole(b_body_t: Vec3, omega_body_radps: Vec3, h: Mat3, k_w: float) -> Vec3:
    """The dipole m = -k_w H (b x Omega), H symmetric and positive definite.

    The power is Omega . (m x b) = -k_w (b x Omega)^T H (b x Omega), never positive. H stands outside the
    product: b x (H Omega) has a power that may be positive.

    Args:
        b_body_t: field in body axes, T.
        omega_body_radps: rate to damp, body axes, rad/s.
        h: H, dimensionless.
        k_w: gain, N m s / T^2.

    Returns:
        Dipole in body axes, A m^2.

    Source: Wisniewski, Blanke 1999, as in Ovchinnikov, Roldugin 2019, section 1 [26], which names a positive
    definite matrix instead of the scalar; the place of H follows from the power.
    """
    return scale(-k_w, transform(h, cross(b_body_t, omega_body_radps)))


def rate_damping_matrix(
    inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig
) -> Demand:
    """Damping of the rate relative to the orbital frame, down to the spin of the setpoint."""
    gains: MatrixGains = config.gains["rate_damping_matrix"]
    if not inputs.attitude.usable:
        return Demand()
    w1, w2, w3 = inputs.attitude.omega_body_orbit_radps
    rate = (w1 - setpoint.spin_radps, w2, w3)
    return Demand(matrix_damping_dipole(inputs.b_body_t, rate, gains.matrix, setpoint.k_w))


LAWS = {
    "rate_damping_matrix": LawEntry(4, Aim.RATE, rate_damping_matrix, rate_damping_matrix, MatrixGains),
}
