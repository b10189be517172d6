"""The limits of a coil driver board, from the table of the coils: for plant, bench, faults and tools."""

from fsw.table.sections import CoilTable
from hil_stub.coils.interlock import CoilLimits


def coil_limits(coils: CoilTable, tick_hz: int) -> CoilLimits:
    """What the interlock enforces; the times to the nearest millisecond.

    The scheduler takes its own limits from the same table, rounded to whole ticks (``fsw.table.config``), so
    that neither relies on the arithmetic of the other.
    """
    return CoilLimits(
        tick_hz=tick_hz,
        pulse_ms=round(1000.0 * coils.pulse_s),
        backoff_ms=round(1000.0 * coils.backoff_s),
        shared=coils.shared,
    )
