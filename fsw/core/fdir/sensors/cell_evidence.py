"""What one tick shows of all Sun cells."""

from collections.abc import Sequence
from typing import final

from fsw.core.estimation.cells.cell_set import Light
from fsw.core.estimation.cells.update import CellsUsed
from fsw.core.estimation.mekf import Estimate


@final
class CellEvidence:
    """What one tick shows of all cells.

    ``currents`` are of isolated cells too; ``light`` is None in the shadow, and ``shadow`` says that this is
    certain. ``sure``: the estimate is proven, and the field confirms it; ``new``: there is none yet, or it
    began in this tick. ``on_trial``: it was proven, has been too uncertain since, and the field confirms it.
    """

    __slots__ = ("currents", "estimate", "light", "new", "on_trial", "shadow", "sure", "used")

    def __init__(
        self,
        currents: Sequence[float | None],
        used: CellsUsed,
        estimate: Estimate | None,
        light: Light | None,
        shadow: bool,
        sure: bool,
        new: bool,
        on_trial: bool = False,
    ) -> None:
        self.currents = currents
        self.used = used
        self.estimate = estimate
        self.light = light
        self.shadow = shadow
        self.sure = sure
        self.new = new
        self.on_trial = on_trial
