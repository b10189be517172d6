"""Sun-cell samples in the filter, one at a time; of a cell's errors only the smallest is white noise."""

from collections.abc import Sequence
from math import hypot
from typing import NamedTuple

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, rotate
from fsw.core.algebra.vector import Vec3, dot, norm, scale
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import CellSet, Light
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.measurement import sun_prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig

LEAST_COSINE = 0.2
"""Of the angle from a cell's normal to the Sun: below it an attitude error may leave the cell dark."""
GATE_NIS = 10.83
"""Chi-square with 1 degree of freedom: 1 in 1000 sound samples is refused."""
SIGMAS = 4.0
"""Beyond this many standard deviations an excess or a gain is outside what the table allows."""
BRIGHT = 2.0
"""Times the threshold: a cell that faces away from the Sun is taken if the Earth alone gives it this much."""
CORRELATION_RAD = 1.0
"""After a rotation by this angle the excess of a cell is little correlated with that before."""
ORBIT_RADPS = 1.1e-3
"""The Earth moves at this rate in the view of a satellite that does not turn."""


class CellsUsed(NamedTuple):
    """Numbers of the cells that the filter took in a tick, and of those that it refused."""

    taken: tuple[int, ...] = ()
    refused: tuple[int, ...] = ()


NO_CELLS = CellsUsed()


CellPrediction = tuple[float, Matrix]
"""What a cell should show without its excess, and the sensitivity, (1, n)."""


def prediction(
    estimate: Estimate, cell: int, seen: Light, config: MekfConfig, cells: CellSet
) -> CellPrediction:
    """What a cell, clear of the edge of its view, should show, and how that depends on the error state.

    Misalignment and age are those of the Sun sensor that the cells replace: common to all cells.
    """
    normal, parts, known = cells.normals_body[cell], config.layout, estimate.parameters
    s, sensitivity = sun_prediction(*estimate[:3], seen.s_eci, config)
    shown, row = 0.0, np.zeros(parts.size)
    direct = dot(normal, s)
    if direct > 0.0:
        gain = 1.0 + (known.cell_gain[cell] if known.cell_gain else 0.0)
        shown, row = gain * direct, gain * np.array(normal).dot(sensitivity)
        if parts.cell_gain is not None:
            row[parts.cell_gain.start + cell] = direct
    if seen.earth > 0.0:
        e, e_sensitivity = sun_prediction(*estimate[:3], seen.e_eci, config)
        view = 0.5 * (1.0 + dot(normal, e))
        of_one = seen.earth / cells.albedo
        earth = seen.earth + of_one * (known.earth_light[0] if known.earth_light else 0.0)
        shown += earth * view * view
        row = row + np.array(scale(earth * view, normal)).dot(e_sensitivity)
        if parts.earth_light is not None:
            row[parts.earth_light.start] = of_one * view * view
    if parts.cells is not None:
        row[parts.cells.start + cell] = 1.0
    return shown, row.reshape(1, -1)


def sunlit(q_body_from_eci: Quaternion, seen: Light, cells: CellSet) -> list[int]:
    """The cells that certainly see the Sun."""
    s = rotate(q_body_from_eci, seen.s_eci)
    return [
        cell
        for cell, normal in enumerate(cells.normals_body)
        if dot(normal, s) > LEAST_COSINE and not cells.shaded(cell, s)
    ]


def earthlit(q_body_from_eci: Quaternion, seen: Light, cells: CellSet) -> list[int]:
    """The cells that face away from the Sun and that the Earth alone lights."""
    s = rotate(q_body_from_eci, seen.s_eci)
    return [
        cell
        for cell, normal in enumerate(cells.normals_body)
        if dot(normal, s) < -LEAST_COSINE and _by_earth(q_body_from_eci, normal, seen) > BRIGHT * cells.dark
    ]


def most_behind(estimate: Estimate, normal: Vec3, seen: Light, cells: CellSet) -> float:
    """The most that a cell facing away from the Sun can show, by the Earth's light and its excess.

    The Earth is as bright as the table has it, or brighter where the cells together have shown that it is.
    """
    known = estimate.parameters.earth_light
    brighter = max(0.0, known[0]) / cells.albedo if known else 0.0
    most = SIGMAS * hypot(cells.excess_sigma, cells.light_sigma)
    return cells.dark + (1.0 + brighter) * _by_earth(estimate.q_body_from_eci, normal, seen) + most


def _by_earth(q_body_from_eci: Quaternion, normal: Vec3, seen: Light) -> float:
    view = 0.5 * (1.0 + dot(normal, rotate(q_body_from_eci, seen.e_eci)))
    return seen.earth * view * view


def update_cells(
    estimate: Estimate, currents: Sequence[float | None], seen: Light | None, config: MekfConfig
) -> tuple[Estimate, CellsUsed]:
    """Take the cells that see the Sun, then those that the Earth lights, each gated by itself.

    A cell that shows nothing is not taken: it may be dead, and one in shadow shows no direction. The Earth's
    light on a cell that faces away from the Sun shows how much of it falls on the others.

    Args:
        estimate: before.
        currents: by cell, fractions of full sunlight; None: not to be used.
        seen: the light; None: none is taken.
        config: the filter.
    """
    cells = config.cells
    if cells is None or seen is None:
        return estimate, NO_CELLS
    accepted: list[int] = []
    refused: list[int] = []
    for cell in sunlit(estimate.q_body_from_eci, seen, cells):
        current = currents[cell]
        if current is None:
            continue
        updated = taken(estimate, cell, current, seen, config, cells) if current > cells.dark else None
        (refused if updated is None else accepted).append(cell)
        estimate = updated or estimate
    for cell in earthlit(estimate.q_body_from_eci, seen, cells):
        current = currents[cell]
        if current is not None and current > cells.dark:
            estimate = taken(estimate, cell, current, seen, config, cells) or estimate
    return estimate, CellsUsed(tuple(accepted), tuple(refused))


def taken(
    estimate: Estimate, cell: int, current: float, seen: Light, config: MekfConfig, cells: CellSet
) -> Estimate | None:
    """The estimate after the current of a cell; None when the gate refuses it."""
    shown, sensitivity = prediction(estimate, cell, seen, config, cells)
    innovation = current - shown - estimate.parameters.cell_excess[cell]
    noise = np.array([[cells.sigma**2]])
    return mekf.take(estimate, (innovation,), sensitivity, noise, config, GATE_NIS)


def faded(estimate: Estimate, config: MekfConfig) -> Estimate:
    """The estimate after a tick in which excess and Earth's light have decayed.

    First-order Markov processes: x <- k x, sigma^2 <- k^2 sigma^2 + (1 - k^2) sigma_0^2, k = 1 / (1 + turn);
    turn is the Earth's motion in view, for the excess of a cell plus the rotation of the satellite.
    """
    parts = config.layout
    if config.cells is None or parts.cells is None:
        return estimate
    passed = config.tick_s * ORBIT_RADPS / CORRELATION_RAD
    turned = passed + config.tick_s * norm(estimate.omega_body_radps) / CORRELATION_RAD
    covariance, known = estimate.covariance.copy(), estimate.parameters
    of_excess, of_light = 1.0 / (1.0 + turned), 1.0 / (1.0 + passed)
    _lose(covariance, parts.cells, of_excess, config)
    known = known._replace(cell_excess=tuple([of_excess * value for value in known.cell_excess]))
    if parts.earth_light is not None:
        _lose(covariance, parts.earth_light, of_light, config)
        known = known._replace(earth_light=(of_light * known.earth_light[0],))
    return estimate._replace(parameters=known, covariance=covariance)


def _lose(covariance: Matrix, place: slice, keep: float, config: MekfConfig) -> None:
    """Scale these states by ``keep`` and bring their variances nearer to those of the prior; in place."""
    covariance[place] *= keep
    covariance[:, place] *= keep
    own = range(place.start, place.stop)
    covariance[own, own] += (1.0 - keep * keep) * config.initial_covariance.diagonal()[place]
