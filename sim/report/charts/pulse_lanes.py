"""The pulses of a flight as data of the page: a lane per coil."""

from collections.abc import Sequence

from sim.audit.findings import COILS, DrivenPulse
from sim.drawing.canvas import AXES_COLOURS
from sim.report.charts.drawn_flight import DrawnFlight
from sim.value_types import Json

MOST_PULSES = 6000
"""Of a coil; of more, only the strongest in each of this many parts of the flight is shown."""


def pulse_lanes(flight: DrawnFlight) -> Json:
    """When each coil was driven, at which level, and for how long it locks out the next pulse."""
    limits = flight.audit.limits
    lanes = []
    for coil, colour in zip(COILS, AXES_COLOURS, strict=True):
        pulses = shown([pulse for pulse in flight.audit.pulses if pulse.coil == coil], flight.length_s)
        lanes.append(
            {
                "label": f"coil {coil}",
                "colour": colour,
                "spans_s": [[round(float(p.start_s), 3), round(float(p.end_s), 3)] for p in pulses],
                "levels": [pulse.level for pulse in pulses],
            }
        )
    return {
        "title": "Every pulse of the flight",
        "height": 200,
        "lanes": lanes,
        "most": limits.max_level,
        "backoff_s": limits.backoff_us / 1e6,
        "shared": limits.shared,
    }


def shown(pulses: Sequence[DrivenPulse], length_s: float) -> Sequence[DrivenPulse]:
    """The pulses of a coil, in order; of very many the strongest of each part of the flight."""
    if len(pulses) <= MOST_PULSES:
        return pulses
    strongest: dict[int, DrivenPulse] = {}
    for pulse in pulses:
        part = int(MOST_PULSES * float(pulse.start_s) / length_s)
        if part not in strongest or abs(pulse.level) > abs(strongest[part].level):
            strongest[part] = pulse
    return list(strongest.values())
