"""What the view shows at one moment, as values of JSON: for the page and for Foxglove."""

from collections.abc import Mapping
from dataclasses import asdict

from fsw.wire.messages import NAMES
from sim.value_types import Json
from sim.watch.flight_view import FlightView
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


def state(view: FlightView) -> Json:
    """The numbers of this moment, flat."""
    sample = view.sample()
    series: Mapping[str, object] = {} if sample is None else asdict(sample)
    coils = view.coils
    return {
        "tick": view.tick,
        "mode": None if view.mode is None else view.mode.name,
        "valid": view.attitude is not None,
        **{name: series.get(name) for name in _SERIES},
        **{f"level_{coil}": level for coil, level in enumerate(coils.levels)},
        "current_ma": coils.current_ma,
        "pulses": coils.pulses,
        "refused": coils.refused,
        "bus_load": view.load.part,
    }


_SERIES = ("turn_deg", "sigma3_deg", "rate_degps", "field_off_deg", "sun_off_deg")


def snapshot(view: FlightView, after: int, sampled: int) -> Json:
    """All that the page draws; of what happened and of the series only what is new.

    Args:
        view: what the frames have shown.
        after: number of the last happening that the page has.
        sampled: number of the last sample that it has.
    """
    coils, quality = view.coils, view.quality
    new = min(len(view.samples), view.sampled - sampled)
    return {
        "state": state(view),
        "time": time_text(view.unix_s).strip(),
        "ended": view.ended,
        "body": _body(view),
        "lockout_ms": coils.lockout_ms,
        "fractions": coils.fractions,
        "used": None
        if quality is None
        else {
            name: bool(getattr(quality, name)) for name in ("mag_used", "mag_blanked", "sun_used", "eclipse")
        },
        "frames_per_s": view.load.frames_per_s,
        "frames": _frames(view),
        "broken": view.broken,
        "sampled": view.sampled,
        "samples": [
            [sample.unix_s, *(getattr(sample, name) for name in _SERIES)]
            for sample in list(view.samples)[len(view.samples) - new :]
        ],
        "happened": view.happened,
        "happenings": [
            (one.number, time_text(one.unix_s)[11:].strip(), one.tick, one.weight.value, one.words)
            for one in view.happenings
            if one.number > after
        ],
    }


def _body(view: FlightView) -> Json:
    """What the picture of the body shows, vectors in body axes; the last pulse, and whether it goes on."""
    now = view.coil_torque()
    driven = now or view.last_pulse
    drawn: Json = {
        "q": view.attitude,
        "sides": view.craft.sides if view.craft is not None else (1.0, 1.0, 1.0),
        "field_t": view.field_body_t(),
        "sun": view.sun_body(),
        "dipole": None if driven is None else driven.dipole,
        "torque": None if driven is None else driven.torque,
        "in_units": driven is not None and driven.in_units,
        "driving": now is not None,
    }
    return drawn


def _frames(view: FlightView) -> list[tuple[str, int]]:
    named = [(NAMES.get(can_id, f"0x{can_id:03X}"), count) for can_id, count in view.frames.most_common()]
    return [*named, (OTHERS, view.other_frames)] if view.other_frames else named
