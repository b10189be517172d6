"""The constant torque on the nominal attitude, as the filter estimates it."""

from fsw.core.algebra.vector import Vec3, add
from fsw.core.estimation.parameters import UNCHANGED_INERTIA, Parameters
from fsw.core.laws.plan.law_axes import LawAxes
from fsw.core.orbit.ephemeris import Reference


def constant_torque(parameters: Parameters, reference: Reference | None, axes: LawAxes | None) -> Vec3:
    """The estimated torque, plus that of the estimated error of the inertia, body axes, N m.

    The latter is 3 w0^2 e1 x dJ e1 - w0^2 e3 x dJ e3 on the nominal attitude, e1 and e3 axes of the laws.
    """
    if reference is None or parameters.inertia_error_kgm2 == UNCHANGED_INERTIA:
        return parameters.torque_body_nm
    square = reference.orbit_rate_radps**2
    xx, yy, zz, xy, xz, yz = parameters.inertia_error_kgm2
    if axes is not None:
        (_, xy, xz), (_, _, yz), _ = axes.matrix(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    resting_nm = (square * yz, -4.0 * square * xz, 3.0 * square * xy)
    return add(parameters.torque_body_nm, resting_nm if axes is None else axes.to_body(resting_nm))
