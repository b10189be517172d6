"""The result of a replay for programs."""

from typing import Any

from sim.replay.command import ReplayReport


def as_json(report: ReplayReport) -> dict[str, Any]:
    """Whether it is as exact as it must be and, for a replay through the flight software, how exact."""
    values: dict[str, Any] = {"ok": report.ok, "lines": report.lines}
    result = report.result
    if result is None:
        return values
    return values | {
        "bit_exact": result.bit_exact,
        "command_exact": result.command_exact,
        "ticks": result.ticks,
        "frames": result.frames,
        "first_bit_difference": _text(result.first_bit_difference),
        "first_command_difference": _text(result.first_command_difference),
        "complete": result.ended,
    }


def _text(difference: object) -> str | None:
    return None if difference is None else str(difference)
