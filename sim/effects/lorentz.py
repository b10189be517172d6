"""The torque of the Lorentz force on a charged satellite."""

from dataclasses import dataclass

from fsw.input.quantities import quantity
from sim.plant.own_effects import Moment
from sim.plant.rotation import Vec3, cross, matrix, transform

EARTH_RADPS = 7.2921159e-5
"""Rate at which the field turns with the Earth."""


@dataclass(frozen=True)
class ChargedBody:
    """A charge moment P, the sum of charge times place from the mass centre, body axes, micro C m."""

    moment_1_ucm: float = quantity(1.0, "micro C m", least=-1e6, most=1e6)
    moment_2_ucm: float = quantity(0.0, "micro C m", least=-1e6, most=1e6)
    moment_3_ucm: float = quantity(0.0, "micro C m", least=-1e6, most=1e6)

    def torque_body_nm(self, moment: Moment) -> Vec3:
        """P x (v x b), body axes, N m, at the instant of the tick."""
        charge = (1e-6 * self.moment_1_ucm, 1e-6 * self.moment_2_ucm, 1e-6 * self.moment_3_ucm)
        v_eci = velocity_in_field(moment.r_eci_m, moment.v_eci_mps)
        return lorentz_torque(charge, transform(matrix(moment.q_body_from_eci), v_eci), moment.b_body_t)


def lorentz_torque(charge_body_cm: Vec3, velocity_body_mps: Vec3, b_body_t: Vec3) -> Vec3:
    """T = P x (v x b) [N m]: on each charge q at rho acts q v x b, and P is the sum of q rho.

    The fields on all charges are taken as that of the mass centre, and the part q omega x rho of their
    velocity, under 1e-5 of v, is left out. T has no part along v x b; m x b has none along b, normal to it:
    together they reach every direction where v is not along b.

    Args:
        charge_body_cm: P, body axes, C m.
        velocity_body_mps: v against the field, which turns with the Earth, body axes.
        b_body_t: field, body axes.

    Source: Antipov, Tikhonov 2007, as in Ovchinnikov, Roldugin 2019, section 2.4 [65], which names the force;
    the torque follows from it.
    """
    return cross(charge_body_cm, cross(velocity_body_mps, b_body_t))


def velocity_in_field(r_eci_m: Vec3, v_eci_mps: Vec3) -> Vec3:
    """V - omega_E x r, eci, m/s."""
    (x, y, _), (vx, vy, vz) = r_eci_m, v_eci_mps
    return (vx + EARTH_RADPS * y, vy - EARTH_RADPS * x, vz)
