"""The attitude relative to the orbital frame: as estimated, or as the reference messages give it."""

from fsw.core.algebra.quaternion import canonical, conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import scale, sub
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.mekf import Estimate
from fsw.core.gate.readings import Readings
from fsw.core.orbit.ephemeris import Reference


def orbital_attitude(estimate: Estimate | None, reference: Reference, valid_sigma_rad: float) -> Attitude:
    """The estimate relative to the orbital frame, valid up to this standard deviation of its worst axis."""
    if estimate is None:
        return UNKNOWN
    q = canonical(multiply(conjugate(reference.q_orbit_from_eci), estimate.q_body_from_eci))
    e3_body = rotate(q, (0.0, 0.0, 1.0))
    omega = sub(estimate.omega_body_radps, scale(reference.orbit_rate_radps, e3_body))
    variances: list[float] = estimate.covariance.diagonal().tolist()
    sigma_attitude, sigma_rate = max(variances[0:3]) ** 0.5, max(variances[3:6]) ** 0.5
    return Attitude(q, omega, 3.0 * sigma_attitude, 3.0 * sigma_rate, sigma_attitude <= valid_sigma_rad)


def perfect_attitude(readings: Readings, before: Attitude) -> Attitude:
    """The attitude the reference messages give; the one before, no longer valid, where they are missing."""
    q, w = readings.ref_attitude, readings.ref_rate
    if q is None or w is None or not q.valid or not w.valid:
        return before._replace(valid=False)
    scalar = max(0.0, 1.0 - q.q_x**2 - q.q_y**2 - q.q_z**2) ** 0.5
    near_unit = (scalar, q.q_x, q.q_y, q.q_z)  # near 180 deg rounding makes the vector longer than 1
    return Attitude(normalise(near_unit), (w.w_x, w.w_y, w.w_z), 0.0, 0.0, True)
