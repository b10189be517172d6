"""The predictive law of PoSAT-1: the impulse that would bring the rate to its reference by the pulse's end.

At each opportunity the rate one pulse ahead is predicted without control,

    Omega+ = Omega + dt (domega/dt + w0 Omega x e3),
    J domega/dt = 3 mu/r^3 e1 x J e1 - omega x (J omega + h) + d + m_r x b,

d the estimated torque and m_r the estimated residual dipole, which the paper does not have,
and what is missing, r = J (Omega_ref - Omega+), is the impulse demanded. The cost of m for dt,
1/2 (Omega+ - Omega_ref)^T J (Omega+ - Omega_ref), is then 1/2 (r - dt m x b)^T J^-1 (r - dt m x b): the
actuator looks for its least value, over the 18 pulses and none, or over all dipoles.

Source: Tavares et al. (ConSat, PoSAT-1), eq. 5 and 18.
"""

from fsw.core.algebra.quaternion import dcm
from fsw.core.algebra.vector import Mat3, Vec3, add, cross, dot, scale, sub, transform, transpose
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.motion import wheel_momentum
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference


def free_rate_change(
    omega_body_orbit_radps: Vec3,
    c_body_from_orbit: Mat3,
    orbit_rate_radps: float,
    radius_m: float,
    inertia_kgm2: Mat3,
    inertia_inverse: Mat3,
    wheel_body_nms: Vec3,
) -> Vec3:
    """dOmega/dt without control or disturbance, body axes, rad/s^2.

    Args:
        omega_body_orbit_radps: Omega, rate relative to the orbital frame, body axes.
        c_body_from_orbit: attitude.
        orbit_rate_radps: w0.
        radius_m: distance from the Earth's centre.
        inertia_kgm2: J, body axes.
        inertia_inverse: J^-1.
        wheel_body_nms: h, momentum of wheels, body axes.
    """
    e1, _, e3 = transpose(c_body_from_orbit)
    omega = add(omega_body_orbit_radps, scale(orbit_rate_radps, e3))
    gravity = scale(3.0 * MU_M3PS2 / radius_m**3, cross(e1, transform(inertia_kgm2, e1)))
    gyroscopic = cross(omega, add(transform(inertia_kgm2, omega), wheel_body_nms))
    turning = scale(orbit_rate_radps, cross(omega_body_orbit_radps, e3))
    return add(transform(inertia_inverse, sub(gravity, gyroscopic)), turning)


def free_change(inputs: LawInput, reference: Reference, config: ControlConfig) -> Vec3:
    """The same for what a law sees, with a usable attitude and the orbit ``reference``."""
    return free_rate_change(
        inputs.attitude.omega_body_orbit_radps,
        dcm(inputs.attitude.q_body_from_orbit),
        reference.orbit_rate_radps,
        reference.radius_m,
        config.inertia_kgm2,
        config.inertia_inverse,
        wheel_momentum(inputs, config),
    )


def missing_impulse(
    omega_body_orbit_radps: Vec3,
    free_change_radps2: Vec3,
    reference_radps: Vec3,
    horizon_s: float,
    inertia_kgm2: Mat3,
) -> Vec3:
    """The impulse r = J (Omega_ref - Omega - dt dOmega/dt), body axes, N m s."""
    predicted = add(omega_body_orbit_radps, scale(horizon_s, free_change_radps2))
    return transform(inertia_kgm2, sub(reference_radps, predicted))


def best_impulse(impulse_body_nms: Vec3, b_body_t: Vec3, inertia_kgm2: Mat3) -> Vec3:
    """The impulse p normal to b with the least (r - p)^T J^-1 (r - p): p = r - J b (b . r) / (b . J b).

    The closed-form minimiser for coils without limits; ``b_body_t`` must not be zero.
    """
    weighted = transform(inertia_kgm2, b_body_t)
    return sub(impulse_body_nms, scale(dot(b_body_t, impulse_body_nms) / dot(b_body_t, weighted), weighted))


def disturbance_nm(inputs: LawInput) -> Vec3:
    """The estimated torque and that of the estimated residual dipole, d + m_r x b, body axes, N m."""
    return add(inputs.torque_body_nm, cross(inputs.dipole_body_am2, inputs.b_body_t))


def predictive(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The impulse missing at the end of a pulse fired now."""
    attitude, reference = inputs.attitude, inputs.reference
    if not attitude.usable or reference is None:
        return Demand()
    change = free_change(inputs, reference, config)
    disturbed = transform(config.inertia_inverse, disturbance_nm(inputs))
    wanted = (setpoint.spin_radps, 0.0, 0.0)
    return Demand(
        impulse_body_nms=missing_impulse(
            attitude.omega_body_orbit_radps,
            add(change, disturbed),
            wanted,
            config.horizon_s,
            config.inertia_kgm2,
        )
    )


LAWS = {
    "predictive": LawEntry(3, Aim.RATE, predictive, predictive),
}
