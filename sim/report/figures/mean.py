"""Mean, root mean square and maximum of values that come block by block."""

from dataclasses import dataclass

import numpy as np

from sim.value_types import Array


@dataclass(slots=True)
class Mean:
    """Number, sum, sum of squares and maximum of values."""

    count: int = 0
    total: float = 0.0
    squares: float = 0.0
    most: float = -np.inf

    def take(self, values: Array) -> None:
        """Take further values."""
        if len(values):
            self.count += len(values)
            self.total += float(values.sum())
            self.squares += float((values**2).sum())
            self.most = max(self.most, float(values.max()))

    @property
    def mean(self) -> float:
        """Of at least one value."""
        return self.total / self.count

    @property
    def rms(self) -> float:
        """Root mean square of at least one value."""
        return float(np.sqrt(self.squares / self.count))
