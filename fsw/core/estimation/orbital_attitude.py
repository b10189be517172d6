"""The attitude relative to the orbital frame: as estimated, or as the reference messages give it."""

from typing import Final

from fsw.core.algebra.quaternion import canonical, conjugate, multiply, normalise, rotate
from fsw.core.algebra.vector import norm, scale, sub
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.estimation.kalman import Matrix, largest_variance
from fsw.core.estimation.mekf import Estimate
from fsw.core.gate.measurements import Measurements
from fsw.core.orbit.ephemeris import Reference

KEPT: Final = 1.5
"""Times the sigma at which an attitude becomes valid: up to that it stays so."""
MOST_TURN_RAD: Final = 0.2
MOST_AGED_TURN_RAD: Final = 0.1
"""In a tick; the second where the samples' age is estimated. Of a body that turns further the filter's linear
steps say too much: at 0.15 to 0.3 rad it took ages that no sample shows for known within 0.06 s, and they
were wrong by 0.4 s, the attitude by 7 deg; without ages it was wrong by 0.4 deg, which its 3 sigma denied."""


def orbital_attitude(
    estimate: Estimate | None,
    reference: Reference,
    valid_sigma_rad: float,
    usable_sigma_rad: float,
    fastest_valid_radps: float,
    was_valid: bool = False,
) -> Attitude:
    """The estimate relative to the orbital frame.

    Usable up to ``usable_sigma_rad`` about its worst axis. It becomes valid at ``valid_sigma_rad`` in any
    direction, and stays so up to ``KEPT`` times that: in a shadow it is less certain for a while, not wrong.
    It is not while the body turns faster than ``fastest_valid_radps``.
    """
    if estimate is None:
        return UNKNOWN
    q = canonical(multiply(conjugate(reference.q_orbit_from_eci), estimate.q_body_from_eci))
    e3_body = rotate(q, (0.0, 0.0, 1.0))
    omega = sub(estimate.omega_body_radps, scale(reference.orbit_rate_radps, e3_body))
    sigma_attitude = largest_variance(estimate.covariance, 0, 3) ** 0.5
    sigma_rate = largest_variance(estimate.covariance, 3, 6) ** 0.5
    usable = sigma_attitude <= usable_sigma_rad
    most_rad = (KEPT if was_valid else 1.0) * valid_sigma_rad
    slow = norm(estimate.omega_body_radps) <= fastest_valid_radps
    valid = usable and slow and _most_variance(estimate.covariance) <= most_rad * most_rad
    return Attitude(q, omega, 3.0 * sigma_attitude, 3.0 * sigma_rate, valid, usable)


def _most_variance(covariance: Matrix) -> float:
    """At least the variance of the attitude in the direction in which it is largest (Gershgorin 1931)."""
    most = 0.0
    for row in range(3):
        spread = 0.0
        for column in range(3):
            spread += abs(float(covariance[row, column]))
        most = max(most, spread)
    return most


def perfect_attitude(measurements: Measurements, before: Attitude) -> Attitude:
    """The attitude the reference messages give; the one before, no longer usable, where they are missing."""
    attitude, rate = measurements.ref_attitude, measurements.ref_rate
    if attitude is None or rate is None or not attitude.valid or not rate.valid:
        return before.invalid()
    q1, q2, q3 = attitude.vector
    scalar = max(0.0, 1.0 - q1**2 - q2**2 - q3**2) ** 0.5
    near_unit = (scalar, q1, q2, q3)  # near 180 deg rounding makes the vector longer than 1
    return Attitude(normalise(near_unit), rate.vector, 0.0, 0.0, True)
