"""The time axis of a pass, with its eclipses."""

import numpy as np

from sim.commissioning.recorded.along import Along
from sim.drawing.canvas import Span, TimeAxis

LONG_S = 1200.0


def pass_time(around: Along) -> TimeAxis:
    """Minutes of a long pass, seconds of a short one."""
    end_s = max(float(around.t_s[-1]), around.tick_s)
    unit_s, unit = (60.0, "min") if end_s > LONG_S else (1.0, "s")
    return TimeAxis(f"time since the first row [{unit}]", unit_s, 0.0, end_s, _eclipses(around))


def _eclipses(around: Along) -> tuple[Span, ...]:
    """Spans of rows in the shadow of the Earth."""
    dark = np.concatenate(([False], ~around.lit, [False]))
    edges = np.flatnonzero(dark[1:] != dark[:-1])
    return tuple(
        (float(around.t_s[first]), float(around.t_s[min(after, len(around.t_s) - 1)]))
        for first, after in zip(edges[::2], edges[1::2], strict=True)
    )
