"""triad_mekf.csv: attitude from two directions, by TRIAD and by the filter's update."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from fsw.core.algebra.quaternion import normalise
from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.estimation.mekf import Estimate, start, update_both
from fsw.core.estimation.mekf_config import mekf_config
from fsw.core.estimation.start.triad import triad
from sim.errors import HarnessError
from sim.report.figures.attitude_arrays import angle_rad, relative
from sim.validate.reference.comparison import ReferenceComparison
from sim.validate.reference.reference_table import ReferenceTable, names_of
from sim.value_types import Array

ATTITUDE_RAD = 1e-9
ROUNDING_RAD = 1e-12
"""Divided by the gap of the two largest eigenvalues: rounding error where that is larger."""
COVARIANCE = 1e-9
"""Relative to the standard deviations of row and column."""
ROUNDING = 1e-14
"""Times the condition number of the covariance: rounding error where that is larger."""
PRIOR = 10.0
"""The filter's prior standard deviation over the largest one that is expected after the update."""

PARTS = ("xx", "yy", "zz", "xy", "xz", "yz")
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, slots=True)
class DirectionPair:
    """Two directions, measured and modelled, with their standard deviations."""

    b1: Vec3
    b2: Vec3
    r1: Vec3
    r2: Vec3
    sigma1_rad: float
    sigma2_rad: float


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare attitudes and the filter's covariance at every row.

    Raises:
        HarnessError: a row is malformed.
    """
    pairs, gap = _pairs(table), np.maximum(table.column("gap"), 1e-300)
    q_true, q_triad, q_best = (_quaternions(table, name) for name in ("q_true", "q_triad", "q_dav"))
    ours = np.array([triad(pair.b1, pair.b2, pair.r1, pair.r2) for pair in pairs])
    yield ReferenceComparison("triad", "TRIAD", "rad", _angle(ours, q_triad), ATTITUDE_RAD)
    yield ReferenceComparison(
        "triad_error",
        "TRIAD's angle from the true attitude",
        "rad",
        np.abs(_angle(ours, q_true) - table.column("err_triad_rad")),
        ATTITUDE_RAD,
    )
    expected = _covariances(table)
    updated = [update(pair, q, p) for pair, q, p in zip(pairs, q_best, expected, strict=True)]
    moved = np.array([estimate.q_body_from_eci for estimate in updated])
    allowed = np.maximum(ATTITUDE_RAD, ROUNDING_RAD / gap)
    yield ReferenceComparison(
        "filter",
        "What the filter's update moves the best attitude (Davenport) by",
        "rad",
        _angle(moved, q_best),
        allowed,
    )
    yield ReferenceComparison(
        "filter_error",
        "The filter's angle from the true attitude",
        "rad",
        np.abs(_angle(moved, q_true) - table.column("err_dav_rad")),
        allowed,
    )
    yield ReferenceComparison(
        "covariance",
        "The filter's covariance after both directions, relative",
        "1",
        np.array([_covariance_error(e, p) for e, p in zip(updated, expected, strict=True)]),
        np.maximum(COVARIANCE, ROUNDING * np.linalg.cond(expected)),
    )


def update(pair: DirectionPair, q_body_from_ref: Array, covariance: Array) -> Estimate:
    """The estimate of the flight filter from a wide prior, after an update with both directions."""
    q0, q1, q2, q3 = q_body_from_ref.tolist()
    config = mekf_config(
        ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        1.0,
        {},
        magnetometer_sigma_t=pair.sigma1_rad,
        sun_sigma_rad=pair.sigma2_rad,
        attitude_sigma_rad=_prior_sigma(covariance),
        rate_sigma_radps=1.0,
        torque_noise_nm_rts=0.0,
        gate_nis=inf,
    )
    estimate = start(normalise((q0, q1, q2, q3)), ZERO, config)
    update_both(estimate, pair.b1, pair.r1, pair.b2, pair.r2, config)
    return estimate


def _prior_sigma(covariance: Array) -> float:
    return PRIOR * float(np.sqrt(np.trace(covariance)))


def _covariance_error(estimate: Estimate, reference: Array) -> float:
    """The deviation from inv(inv(P_reference) + inv(P_prior)), relative to the standard deviations."""
    prior = np.eye(3) / _prior_sigma(reference) ** 2
    expected = np.linalg.inv(np.linalg.inv(reference) + prior)
    sigma = np.sqrt(np.diag(expected))
    return float((np.abs(estimate.covariance[:3, :3] - expected) / np.outer(sigma, sigma)).max())


def _pairs(table: ReferenceTable) -> list[DirectionPair]:
    names = [name for stem in ("b1_", "b2_", "r1_", "r2_") for name in names_of(stem, "xyz")]
    rows = table.columns(*names, "sigma1_rad", "sigma2_rad").tolist()
    return [
        DirectionPair((a, b, c), (d, e, f), (g, h, i), (j, k, m), sigma1, sigma2)
        for a, b, c, d, e, f, g, h, i, j, k, m, sigma1, sigma2 in rows
    ]


def _quaternions(table: ReferenceTable, name: str) -> Array:
    return table.columns(*names_of(f"{name}_", range(4)))


def _covariances(table: ReferenceTable) -> Array:
    parts = table.columns(*names_of("p_dav_", PARTS))
    matrices = np.zeros((len(parts), 3, 3))
    for part, (i, j) in enumerate(PLACES):
        matrices[:, i, j] = matrices[:, j, i] = parts[:, part]
    for line, matrix in zip(table.lines, matrices, strict=True):
        if not np.linalg.eigvalsh(matrix).min() > 0.0:
            raise HarnessError(f"{table.path}, line {line}, column p_dav_xx: not a covariance")
    return matrices


def _angle(p: Array, q: Array) -> Array:
    """Angle between attitudes; a norm that is not 1 counts too."""
    norm = np.linalg.norm(q, axis=1)
    angle: Array = np.maximum(angle_rad(relative(p, q / norm[:, None])), np.abs(norm - 1.0))
    return angle
