"""Robustness: the degree of stability of gains on another body than the one they were designed for.

The law does not use the inertia, so its gains stay while the body's tensor is another one. The errors are of:

- the moments, J = D J_believed D with D^2 = diag(1 + e); moments that no body has (one greater than the sum
  of the others) are left out;
- the spread of mass along each body axis, S = D S_believed D with S = tr(J) / 2 I - J, the integral of
  r r^T dm: every error of it is a body, however slender;
- the directions of the principal axes.
"""

from dataclasses import dataclass
from itertools import combinations, pairwise, product

import numpy as np
from scipy.spatial.transform import Rotation

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import NEUTRAL, ROUGH_STEPS, degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.design.theory.search import Degree
from sim.value_types import Array

PAIRS = tuple(combinations(range(3), 2))
"""Pairs of body axes, by number from 0."""
ERRORS = np.linspace(-0.5, 0.5, 21)
"""Relative errors of a spread of mass that the maps show."""
TILTS_DEG = np.linspace(-45.0, 45.0, 61)
"""Turns of the principal axes that the curves show."""
SCAN = np.geomspace(0.005, 0.5, 24)
"""Relative errors over which a margin is sought."""
FACTORS = np.geomspace(0.01, 100.0, 121)
"""Factors over which gain margins are sought."""

_DIRECTIONS = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=3) if any(way)])


@dataclass(frozen=True, slots=True)
class InertiaMaps:
    """Degrees of stability against the error of two spreads of mass at a time.

    Attributes:
        errors: relative errors, (k,).
        degree: ``degree[p, i, j]`` with the spread along the first axis of pair p off by ``errors[j]`` and
            along the second by ``errors[i]``.
        tilts_deg: turns of the principal axes about a body axis, (t,).
        tilted: degrees of stability, (3, t), a row per body axis.
    """

    errors: Array
    degree: Array
    tilts_deg: Array
    tilted: Array


@dataclass(frozen=True, slots=True)
class Margins:
    """The errors at which the degree of stability is no longer negative; None: beyond the scan.

    Attributes:
        k_w: factors down and up, on k_w alone.
        k_a: factors down and up, on k_a alone.
        both: factors down and up, on both.
        half: the same as ``both``, before half the degree is lost.
        moments: relative error of the moments of inertia, each with its own sign.
        spreads: relative error of the spreads of mass, each with its own sign.
        tilt_deg: turn of the principal axes about any one body axis.
    """

    k_w: tuple[float | None, float | None]
    k_a: tuple[float | None, float | None]
    both: tuple[float | None, float | None]
    half: tuple[float | None, float | None]
    moments: float | None
    spreads: float | None
    tilt_deg: float | None


def degrees(body: Body, gains: Gains, inertia_kgm2: Array) -> Array:
    """Degrees of stability, shape (...), of one pair of gains on tensors (..., 3, 3); NaN for no body."""
    result = degree_of_stability(monodromy(closed_loop(body, gains, inertia_kgm2), ROUGH_STEPS))
    moments = np.linalg.eigvalsh(inertia_kgm2)
    return np.where(moments[..., 0] + moments[..., 1] >= moments[..., 2], result, np.nan)


def wrong_moments(body: Body, errors: Array) -> Array:
    """Tensors (..., 3, 3) of the body with its moments off by relative ``errors`` (..., 3)."""
    root = np.sqrt(1.0 + errors)
    tensors: Array = np.asarray(body.inertia_kgm2) * root[..., :, None] * root[..., None, :]
    return tensors


def wrong_spreads(body: Body, errors: Array) -> Array:
    """Tensors (..., 3, 3) of the body with its spreads of mass off by relative ``errors`` (..., 3)."""
    root = np.sqrt(1.0 + errors)
    inertia = np.asarray(body.inertia_kgm2)
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    spread = spread * root[..., :, None] * root[..., None, :]
    tensors: Array = np.trace(spread, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - spread
    return tensors


def tilted(body: Body, axis: int, angles_deg: Array) -> Array:
    """Tensors (k, 3, 3) of the body with its mass turned about a body axis."""
    turn = Rotation.from_rotvec(np.radians(angles_deg)[:, None] * np.eye(3)[axis]).as_matrix()
    tensors: Array = turn @ np.asarray(body.inertia_kgm2) @ turn.swapaxes(-1, -2)
    return tensors


def inertia_maps(body: Body, gains: Gains) -> InertiaMaps:
    """The maps of one pair of gains."""
    first, second = np.meshgrid(ERRORS, ERRORS)
    maps = []
    for one, other in PAIRS:
        errors = np.zeros((*first.shape, 3))
        errors[..., one], errors[..., other] = first, second
        maps.append([degrees(body, gains, row) for row in wrong_spreads(body, errors)])
    tilts = [degrees(body, gains, tilted(body, axis, TILTS_DEG)) for axis in range(3)]
    return InertiaMaps(ERRORS, np.array(maps), TILTS_DEG, np.array(tilts))


def margins(body: Body, gains: Gains, degree: Degree) -> Margins:
    """The margins of one pair of gains, on the grids of this module, with the degree of its own body."""
    now = float(degree(gains))
    one = np.ones_like(FACTORS)
    k_w, k_a = (degree(Gains(gains.k_w * w, gains.k_a * a)) for w, a in ((FACTORS, one), (one, FACTORS)))
    both = degree(gains.scaled(FACTORS))
    moments, spreads = (
        np.array([_worst(body, gains, wrong(body, error * _DIRECTIONS)) for error in SCAN])
        for wrong in (wrong_moments, wrong_spreads)
    )
    angles = TILTS_DEG[TILTS_DEG >= 0.0]
    turned = [
        np.fmax(*(degrees(body, gains, tilted(body, axis, way * angles)) for way in (-1.0, 1.0)))
        for axis in range(3)
    ]
    return Margins(
        _factors(k_w, -NEUTRAL),
        _factors(k_a, -NEUTRAL),
        _factors(both, -NEUTRAL),
        _factors(both, min(-NEUTRAL, 0.5 * now)),
        _first(SCAN, moments),
        _first(SCAN, spreads),
        _first(angles, np.nanmax(turned, axis=0)),
    )


def _worst(body: Body, gains: Gains, tensors: Array) -> float:
    values = degrees(body, gains, tensors)
    return float(np.nanmax(values)) if np.isfinite(values).any() else -np.inf


def _first(places: Array, values: Array) -> float | None:
    """The first place at which a degree is no longer stable."""
    lost = np.flatnonzero(values >= -NEUTRAL)
    return float(places[lost[0]]) if lost.size else None


def _factors(values: Array, level: float) -> tuple[float | None, float | None]:
    """The factors next below and above one at which the level is reached, interpolated in the logarithm."""
    middle, logs, above = len(FACTORS) // 2, np.log(FACTORS), values - level
    if above[middle] >= 0.0:
        return (1.0, 1.0)

    def crossing(ways: range) -> float | None:
        for before, after in pairwise(ways):
            if above[after] >= 0.0:
                part = above[before] / (above[before] - above[after])
                return float(np.exp(logs[before] + part * (logs[after] - logs[before])))
        return None

    return crossing(range(middle, -1, -1)), crossing(range(middle, len(FACTORS)))
