"""The torque on the nominal attitude that does not change, as the filter estimates it."""

from fsw.core.algebra.vector import ZERO, Vec3, add
from fsw.core.estimation.parameters import UNCHANGED_INERTIA, Parameters, inertia_error
from fsw.core.laws.plan.riccati import resting_torque
from fsw.core.orbit.ephemeris import Reference


def constant_torque(parameters: Parameters, reference: Reference | None) -> Vec3:
    """The estimated torque, and that of the inertia that the table does not know, body axes, N m."""
    if reference is None or parameters.inertia_error_kgm2 == UNCHANGED_INERTIA:
        return parameters.torque_body_nm
    resting = resting_torque(inertia_error(parameters), ZERO, reference.orbit_rate_radps)
    return add(parameters.torque_body_nm, resting)
