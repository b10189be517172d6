"""What is seen at one moment, as values of JSON: for the page and for Foxglove."""

from collections.abc import Mapping
from dataclasses import asdict

from fsw.wire.messages import NAMES
from sim.value_types import Json
from sim.watch.seen import FlightView
from sim.watch.terminal import OTHERS, time_text

STATE_SCHEMA: Json = {
    "type": "object",
    "title": "torquer.State",
    "properties": {
        "tick": {"type": ["integer", "null"]},
        "mode": {"type": ["string", "null"]},
        "valid": {"type": "boolean"},
        "turn_deg": {"type": ["number", "null"]},
        "sigma3_deg": {"type": ["number", "null"]},
        "rate_degps": {"type": ["number", "null"]},
        "field_off_deg": {"type": ["number", "null"]},
        "sun_off_deg": {"type": ["number", "null"]},
        "level_0": {"type": "integer"},
        "level_1": {"type": "integer"},
        "level_2": {"type": "integer"},
        "current_ma": {"type": "integer"},
        "pulses": {"type": "integer"},
        "refused": {"type": "integer"},
        "bus_load": {"type": "number"},
    },
}
"""JSON schema of ``state``, by which Foxglove offers the series."""


def state(seen: FlightView) -> Json:
    """The numbers of this moment, flat."""
    sample = seen.sample()
    series: Mapping[str, object] = {} if sample is None else asdict(sample)
    coils = seen.coils
    return {
        "tick": seen.tick,
        "mode": None if seen.mode is None else seen.mode.name,
        "valid": seen.attitude is not None,
        **{name: series.get(name) for name in _SERIES},
        **{f"level_{coil}": level for coil, level in enumerate(coils.levels)},
        "current_ma": coils.current_ma,
        "pulses": coils.pulses,
        "refused": coils.refused,
        "bus_load": seen.load.part,
    }


_SERIES = ("turn_deg", "sigma3_deg", "rate_degps", "field_off_deg", "sun_off_deg")


def snapshot(seen: FlightView, after: int, sampled: int) -> Json:
    """All that the page draws; of what happened and of the series only what is new.

    Args:
        seen: what the frames have shown.
        after: number of the last happening that the page has.
        sampled: number of the last sample that it has.
    """
    coils, quality = seen.coils, seen.quality
    new = min(len(seen.samples), seen.sampled - sampled)
    return {
        "state": state(seen),
        "time": time_text(seen.unix_s).strip(),
        "ended": seen.ended,
        "arrows": seen.arrows(),
        "lockout_ms": coils.lockout_ms,
        "fractions": coils.fractions,
        "used": None
        if quality is None
        else {
            name: bool(getattr(quality, name)) for name in ("mag_used", "mag_blanked", "sun_used", "eclipse")
        },
        "frames_per_s": seen.load.frames_per_s,
        "frames": _frames(seen),
        "broken": seen.broken,
        "sampled": seen.sampled,
        "samples": [
            [sample.unix_s, *(getattr(sample, name) for name in _SERIES)]
            for sample in list(seen.samples)[len(seen.samples) - new :]
        ],
        "happened": seen.happened,
        "happenings": [
            (one.number, time_text(one.unix_s)[11:].strip(), one.tick, one.weight.value, one.words)
            for one in seen.happenings
            if one.number > after
        ],
    }


def _frames(seen: FlightView) -> list[tuple[str, int]]:
    named = [(NAMES.get(can_id, f"0x{can_id:03X}"), count) for can_id, count in seen.frames.most_common()]
    return [*named, (OTHERS, seen.other_frames)] if seen.other_frames else named
