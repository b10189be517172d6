"""The Jacobi integral of a body on a circular orbit: what its motion conserves when nothing disturbs it."""

import numpy as np

from sim.plant.environment.orbit import Array


def jacobi_integral(
    inertia_kgm2: Array,
    q_body_from_orbit: Array,
    omega_body_orbit_radps: Array,
    orbit_rate_radps: float,
    wheel_body_nms: Array | None = None,
) -> Array:
    """H = 1/2 W.JW + 3/2 w0^2 e1.Je1 - 1/2 w0^2 e3.Je3 - w0 h.e3 [J], shape (n,).

    e1 and e3 are the radius and the orbit's normal in body axes. Constant under gravity gradient alone on a
    circular orbit; a further torque T changes it at the rate T.W (Beletsky 1966; Hughes 1986, chapter 9).

    Args:
        inertia_kgm2: inertia tensor J, (3, 3).
        q_body_from_orbit: attitudes, scalar first, unit, (n, 4).
        omega_body_orbit_radps: rates W relative to the orbital frame, body axes, (n, 3).
        orbit_rate_radps: w0.
        wheel_body_nms: constant momentum h of wheels relative to the body, (3,); None for none.
    """
    w, x, y, z = np.asarray(q_body_from_orbit).T
    e1 = np.stack([w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)], axis=1)
    e3 = np.stack([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z], axis=1)

    def form(v: Array) -> Array:
        values: Array = np.einsum("ni,ij,nj->n", v, np.asarray(inertia_kgm2), v)
        return values

    kinetic = 0.5 * form(np.asarray(omega_body_orbit_radps))
    potential = orbit_rate_radps**2 * (1.5 * form(e1) - 0.5 * form(e3))
    wheel = 0.0 if wheel_body_nms is None else -orbit_rate_radps * (e3 @ np.asarray(wheel_body_nms))
    integral: Array = kinetic + potential + wheel
    return integral
