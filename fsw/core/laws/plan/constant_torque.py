"""The constant torque on the nominal attitude, as the filter estimates it."""

from fsw.core.algebra.vector import Vec3, add
from fsw.core.estimation.parameters import UNCHANGED_INERTIA, Parameters
from fsw.core.orbit.ephemeris import Reference


def constant_torque(parameters: Parameters, reference: Reference | None) -> Vec3:
    """The estimated torque, plus that of the estimated error of the inertia, body axes, N m.

    The latter is 3 w0^2 e1 x dJ e1 - w0^2 e3 x dJ e3 on the nominal attitude.
    """
    if reference is None or parameters.inertia_error_kgm2 == UNCHANGED_INERTIA:
        return parameters.torque_body_nm
    square = reference.orbit_rate_radps**2
    _, _, _, xy, xz, yz = parameters.inertia_error_kgm2
    return add(parameters.torque_body_nm, (square * yz, -4.0 * square * xz, 3.0 * square * xy))
