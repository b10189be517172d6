"""The samples of Sun cells in the filter: one cell at a time, each with an excess that is no white noise."""

from collections.abc import Sequence
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
"""Of the angle between a cell and the Sun: below it an error of the attitude may leave the cell dark."""
GATE_NIS = 10.83
"""Chi-square of 1 degree of freedom: of sound samples 1 in 1000 is refused."""
SIGMAS = 4.0
"""Beyond so many standard deviations an excess is none that the table allows."""
CORRELATION_RAD = 1.0
"""The excess of a cell has little to do with that before a turn by this angle."""
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
    """What a cell that sees the Sun should show, and how that depends on the error state.

    Turn and age are those of the Sun sensor, whose place the cells take: of all cells at once.
    """
    normal = cells.normals_body[cell]
    s, sensitivity = sun_prediction(*estimate[:3], seen.s_eci, config)
    shown, row = dot(normal, s), np.array(normal).dot(sensitivity)
    if seen.earth > 0.0:
        e, e_sensitivity = sun_prediction(*estimate[:3], seen.e_eci, config)
        view = 0.5 * (1.0 + dot(normal, e))
        shown += seen.earth * view * view
        row = row + np.array(scale(seen.earth * view, normal)).dot(e_sensitivity)
    if config.layout.cells is not None:
        row[config.layout.cells.start + cell] = 1.0
    return shown, row.reshape(1, -1)


def sunlit(q_body_from_eci: Quaternion, seen: Light, cells: CellSet) -> list[int]:
    """The cells that see the Sun for certain."""
    s = rotate(q_body_from_eci, seen.s_eci)
    return [
        cell
        for cell, normal in enumerate(cells.normals_body)
        if dot(normal, s) > LEAST_COSINE and not cells.shaded(cell, s)
    ]


def most_behind(q_body_from_eci: Quaternion, normal: Vec3, seen: Light, cells: CellSet) -> float:
    """The most that a cell can show which the Sun is behind, by the Earth and its excess."""
    view = 0.5 * (1.0 + dot(normal, rotate(q_body_from_eci, seen.e_eci)))
    return cells.dark + seen.earth * view * view + SIGMAS * cells.excess_sigma


def update_cells(
    estimate: Estimate, currents: Sequence[float | None], seen: Light | None, config: MekfConfig
) -> tuple[Estimate, CellsUsed]:
    """Take the cells that see the Sun, one after the other, each gated by itself.

    A cell that shows nothing is not taken: it may be dead, and one in shadow shows no direction.

    Args:
        estimate: before.
        currents: by cell, parts of full sunlight; None: not to be used.
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
    return estimate, CellsUsed(tuple(accepted), tuple(refused))


def taken(
    estimate: Estimate, cell: int, current: float, seen: Light, config: MekfConfig, cells: CellSet
) -> Estimate | None:
    """The estimate after the current of a cell that sees the Sun; None when the gate refuses it."""
    shown, sensitivity = prediction(estimate, cell, seen, config, cells)
    innovation = current - shown - estimate.parameters.cell_excess[cell]
    noise = np.array([[cells.sigma**2]])
    return mekf.take(estimate, (innovation,), sensitivity, noise, config, GATE_NIS)


def faded(estimate: Estimate, config: MekfConfig) -> Estimate:
    """The estimate after a tick in which the excess of each cell has lost part of what it was.

    A first-order Markov process: x <- k x, sigma^2 <- k^2 sigma^2 + (1 - k^2) sigma_0^2, k = 1 / (1 + turn).
    """
    cells, place = config.cells, config.layout.cells
    if cells is None or place is None:
        return estimate
    turn = config.tick_s * (norm(estimate.omega_body_radps) + ORBIT_RADPS) / CORRELATION_RAD
    keep = 1.0 / (1.0 + turn)
    covariance = estimate.covariance.copy()
    covariance[place] *= keep
    covariance[:, place] *= keep
    variances = config.initial_covariance.diagonal()[place]
    covariance[range(place.start, place.stop), range(place.start, place.stop)] += (
        1.0 - keep * keep
    ) * variances
    excess = tuple([keep * value for value in estimate.parameters.cell_excess])
    parameters = estimate.parameters._replace(cell_excess=excess)
    return estimate._replace(parameters=parameters, covariance=covariance)
