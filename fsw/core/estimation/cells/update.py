"""Sun-cell samples in the filter, one at a time; of a cell's errors only the smallest is white noise."""

from collections.abc import Sequence
from typing import ClassVar, final

import numpy as np

from fsw.core.algebra.vector import ZERO, Vec3
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import CellSet, Light
from fsw.core.estimation.cells.prediction import prediction
from fsw.core.estimation.cells.relinearise import Linear, cell_shown
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.wire.value import Value

GATE_NIS = 10.83
"""Chi-square with 1 degree of freedom: 1 in 1000 sound samples is refused."""


@final
class CellsUsed(Value):
    """Numbers of the cells that the filter took in a tick, and of those that it refused."""

    FIELDS: ClassVar[tuple[str, ...]] = ("taken", "refused")
    __slots__ = FIELDS

    def __init__(self, taken: tuple[int, ...] = (), refused: tuple[int, ...] = ()) -> None:
        self.taken = taken
        self.refused = refused


NO_CELLS = CellsUsed()


def update_cells(
    estimate: Estimate,
    currents: Sequence[float | None],
    known: Linear,
    config: MekfConfig,
    cells: CellSet,
    frozen: bool = False,
    wheel_nms: Vec3 = ZERO,
) -> CellsUsed:
    """Take the cells that see the Sun, then those that the Earth lights, each gated by itself.

    A cell that shows nothing is not taken: it may be dead, and one in shadow shows no direction. The Earth's
    light on a cell that faces away from the Sun shows how much of it falls on the others.

    Args:
        estimate: of this tick.
        currents: by cell, fractions of full sunlight; None: not to be used.
        known: what the cells show, about an estimate of this tick.
        config: the filter.
        cells: the cells.
        frozen: whether the parameters keep their values.
        wheel_nms: momentum of a driven wheel, body axes.
    """
    accepted: list[int] = []
    refused: list[int] = []
    for number, cell in enumerate((*known.by_sun, *known.by_earth)):
        current = currents[cell]
        if current is None:
            continue
        took = False
        if current > cells.dark:
            shown, row = cell_shown(known, number, estimate, config)
            took = _take(estimate, current - shown, row, config, cells, frozen, wheel_nms)
        if cell in known.by_sun:
            (accepted if took else refused).append(cell)
    return CellsUsed(tuple(accepted), tuple(refused))


def take_cell(
    estimate: Estimate, cell: int, current: float, light: Light, config: MekfConfig, cells: CellSet
) -> bool:
    """Take the current of a cell; False when the gate refuses it."""
    shown, row = prediction(estimate, cell, light, config, cells)
    innovation = current - shown - estimate.parameters.cell_excess[cell]
    return _take(estimate, innovation, row, config, cells, False, ZERO)


def _take(
    estimate: Estimate,
    innovation: float,
    row: Matrix,
    config: MekfConfig,
    cells: CellSet,
    frozen: bool,
    wheel_nms: Vec3,
) -> bool:
    noise = np.array([[cells.sigma**2]])
    return mekf.take(estimate, (innovation,), row, noise, config, GATE_NIS, 0, frozen, wheel_nms)
