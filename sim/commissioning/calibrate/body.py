"""The body from its motion: the axis of spin by the field, ratios of inertia by the filter.

Without a torque only ratios show, and those that the motion does not depend on stay as declared.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sim.commissioning.recorded.along import Along, sampled
from sim.commissioning.recorded.calibration import PassCalibration
from sim.commissioning.telemetry.follow import Noise, filter_config, follow
from sim.commissioning.telemetry.spin import Spin, spin_axis
from sim.value_types import Array

MOMENT_PART, LEAST_SIGMA = 0.01, 0.001
"""Prior of a moment: this part of how far it is from the greatest, and at least so much of that."""
DETERMINED = 0.5
"""A ratio is determined where its standard deviation is at most this part of its prior's."""


class BodyFit(NamedTuple):
    """The body as the motion shows it.

    Attributes:
        inertia: tensor, body axes, the greatest principal moment being 1.
        ratios: principal moments, those nearest to the body axes x, y, z.
        turn_deg: rotation vector that turns the body axes into the principal axes.
        axis_sigma_deg: of the axis of greatest inertia.
        ratio_sigma: of the ratios; ``determined``: whether the motion tells each, (3).
    """

    inertia: Array
    ratios: Array
    turn_deg: Array
    axis_sigma_deg: float
    ratio_sigma: Array
    determined: NDArray[np.bool_]


def declared_axes(ratios: Array, axis: Array) -> Array:
    """Principal axes, (3, 3) by columns: the body axes turned so that that of the greatest is the axis."""
    greatest = np.eye(3)[int(np.argmax(ratios))]
    towards = axis * np.copysign(1.0, axis @ greatest)
    across = np.cross(greatest, towards)
    sine = float(np.linalg.norm(across))
    angle = np.arctan2(sine, greatest @ towards)
    axes: Array = Rotation.from_rotvec(angle * across / sine if sine > 0.0 else across).as_matrix()
    return axes


def fit_body(
    around: Along, known: PassCalibration, ratios: Array, axis: Array, start: Spin, noise: Noise
) -> BodyFit:
    """Let the filter estimate what the ratios lack, in principal axes, and keep what it tells.

    A body that has lost energy spins about its axis of greatest inertia, so that this axis is that of the
    spin as the field shows it; about it the other two keep their place.

    Raises:
        HarnessError: as ``follow``.
    """
    axes, ratios = declared_axes(ratios, axis), ratios / ratios.max()
    turned = start._replace(
        dcm_body_from_eci=axes.T @ start.dcm_body_from_eci,
        omega_body_radps=axes.T @ start.omega_body_radps,
        bias_nt=axes.T @ start.bias_nt,
    )
    principal = known._replace(matrix=axes.T @ known.matrix)
    prior = prior_sigma(ratios)
    config = filter_config(np.diag(ratios), around.tick_s, noise, np.concatenate((prior, np.zeros(3))))
    end = follow(around, principal, turned, config).ticks[-1].estimate
    sigma = np.sqrt(end.covariance.diagonal()[-6:-3])
    determined = (sigma <= DETERMINED * prior) & (prior > 0.0)
    found = ratios + np.where(determined, end.parameters.inertia_error_kgm2[:3], 0.0)
    turn_deg = np.degrees(Rotation.from_matrix(axes).as_rotvec())
    inertia = axes @ np.diag(found / found.max()) @ axes.T
    return BodyFit(inertia, found / found.max(), turn_deg, axis_sigma_deg(around, known), sigma, determined)


def prior_sigma(ratios: Array) -> Array:
    """Standard deviations of declared moments; the greatest is the unit, and exact."""
    return np.array(
        [0.0 if one == ratios.max() else MOMENT_PART * (1.0 - one) + LEAST_SIGMA for one in ratios]
    )


def axis_sigma_deg(around: Along, known: PassCalibration) -> float:
    """How far the axis of spin by the halves of the pass differs: about twice its standard deviation."""
    field_nt = known.field_nt(around.recorded.mag_nt)[sampled(around)]
    first, second = np.array_split(field_nt, 2)
    return 0.5 * float(np.degrees(np.arccos(min(1.0, abs(float(spin_axis(first) @ spin_axis(second)))))))
