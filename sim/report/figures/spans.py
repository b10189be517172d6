"""Spans of ticks over which something holds."""

import numpy as np
from numpy.typing import NDArray


def spans(holds: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """The first tick of each span and the one past its last, in order."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], holds.astype(np.int8), [0]))))
    return [(int(first), int(past)) for first, past in zip(edges[::2], edges[1::2], strict=True)]
