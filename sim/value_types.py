"""Types that many modules name: arrays and vectors of numbers, an object of JSON."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Numbers = NDArray[np.int64]
Json = dict[str, Any]
Vec3 = tuple[float, float, float]


def vec3(values: Array) -> Vec3:
    """Three numbers as plain floats."""
    x, y, z = values.tolist()
    return (x, y, z)
