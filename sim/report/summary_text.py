"""The summary of a flight as a few lines of text; that of an older version gives what it holds."""

from collections.abc import Iterator

from sim.report.event_words import events_left_out
from sim.report.requirements.judge import Outcome
from sim.scenario.controlled import SLOW_DEGPS
from sim.statistics.settling import HELD_S
from sim.value_types import Json

_HEADS = {Outcome.MET: "met", Outcome.FAILED: "FAILED", Outcome.NOT_JUDGED: "not judged"}


def summary_text(summary: Json) -> str:
    """The summary, its requirements first."""
    heading = f"{summary['scenario']}, seed {summary['seed']}: {summary['sim_seconds']:.0f} s flown"
    if "realtime_factor" in summary:
        heading += f" at {summary['realtime_factor']:.0f} times real time"
    rows = [*_requirements(summary), *_figures(summary)]
    return "\n".join([heading, *(f"  {name:<10} {text}" for name, text in rows)])


def last_orbit(summary: Json) -> str:
    """The time over which the figures of the last orbit are taken."""
    flown = summary.get("orbits", 1.0)
    return "the last orbit" if flown >= 0.999 else f"the whole flight of {flown:.2g} orbits"


def _requirements(summary: Json) -> Iterator[tuple[str, str]]:
    for one in summary.get("requirements", ()):
        yield "required", f"{_HEADS[one['verdict']]}: {one['text']}"
        for reason in one["reasons"]:
            yield "", f"- {reason['text']}"


def _figures(summary: Json) -> Iterator[tuple[str, str]]:
    yield "limits", _limits(summary)
    if (tumble := tumble_words(summary)) is not None:
        yield "rate", tumble
    if "controlled" in summary:
        yield from _pointing(summary)
    elif "pointing_deg" in summary:
        yield "pointing", f"{summary['pointing_deg']['rms_last_orbit']:.2f} deg RMS over the last orbit"
    reasons = [reason["text"] for one in summary.get("requirements", ()) for reason in one["reasons"]]
    for reason in summary.get("diagnosis", {}).get("reasons", ()):
        if reason["text"] not in reasons:
            yield "why", reason["text"]
    if "spin_radps" in summary:
        spin = summary["spin_radps"]
        yield (
            "spin",
            f"{spin['mean_last_orbit']:.5f} rad/s in the mean of {last_orbit(summary)}, "
            f"{spin['max_dev_last_orbit']:.5f} at most off {spin['reference']:g}",
        )
    if "estimate_deg" in summary:
        yield "estimate", _estimate(summary)
    if "mode_final" in summary:
        yield "mode", summary["mode_final"]
    yield "isolated", ", ".join(summary["isolated"]) or "no unit"
    if cut := events_left_out(summary):
        yield "events", f"{summary['event_count']}; {cut[0].lower()}{cut[1:]} are in summary.json"
    if "replay" in summary:
        yield "replay", "bit-exact" if summary["replay"]["bit_exact"] else "NOT bit-exact"
    failed = summary.get("failures", {})
    for name in ("second_senders", "complete"):
        if name in failed:
            yield name.replace("_", " "), failed[name]


def _limits(summary: Json) -> str:
    pulses, gaps_s = summary["pulses"], summary["min_gap_s"]
    gap_s = gaps_s.get("limited", gaps_s["any"])
    text = "kept" if summary["limits_ok"] else "BROKEN"
    if "dipoles" in summary:
        dipoles = summary["dipoles"]
        return (
            f"{text}: driven in {dipoles['driven']} of {dipoles['total']} ticks, {pulses['refused']} refused"
        )
    text += f": {pulses['total']} pulses, {pulses['refused']} refused"
    if "max_pulse_s" in summary:
        text += f", longest {summary['max_pulse_s']:.3f} s"
    return text if gap_s is None else f"{text}, least gap {gap_s:.3f} s"


def _pointing(summary: Json) -> Iterator[tuple[str, str]]:
    """What is controlled, with its settling; body axis 1 in addition to the whole attitude."""
    found = summary["controlled"]
    unit = found["unit"]
    if found["what"] != "axis":
        name = "pointing" if found["what"] == "attitude" else found["what"]
        figures = f"{found['rms_last_orbit']:.2f} {unit} RMS, {found['max_last_orbit']:.2f} {unit} max"
        under = _under(found.get("settle_orbits"), found["threshold"], unit)
        yield name, f"{figures} over {last_orbit(summary)}, {under}"
    axis1 = summary["axis1_deg"]
    under = _under(axis1.get("settle_orbits_5deg"), 5.0, "deg")
    yield "axis 1", f"{axis1['rms_last_orbit']:.2f} deg RMS off the vertical, {under}"


def tumble_words(summary: Json) -> str | None:
    """How a tumble was stopped; None of a flight that began slowly, or of an older summary."""
    rate = summary.get("rate_degps", {"start": 0.0})
    if rate["start"] <= SLOW_DEGPS:
        return None
    per_orbit = summary["orbits"] / summary["sim_seconds"]
    reached = [
        f"under {limit} deg/s from {rate[key] / 3600.0:.1f} h ({rate[key] * per_orbit:.1f} orbits) on"
        if key in rate
        else f"not under {limit} deg/s"
        for limit, key in (("1", "under_1_s"), ("0.1", "under_0.1_s"))
    ]
    return f"{rate['start']:.1f} deg/s at the start, {rate['final']:.2f} at the end; {', '.join(reached)}"


def _under(settled: float | None, threshold: float, unit: str) -> str:
    if settled is None:
        return f"not settled: not under {threshold:g} {unit} for the last {HELD_S:g} s"
    return f"under {threshold:g} {unit} from {settled:.2f} orbits on"


def _estimate(summary: Json) -> str:
    error = summary["estimate_deg"]
    named = (("rms_sunlit", "RMS sunlit"), ("rms_eclipse", "RMS in eclipse"), ("max", "max"))
    parts = [f"{error[key]:.3f} deg {text}" for key, text in named if key in error]
    if error["within_3sigma"] is not None:
        parts.append(f"inside its 3 sigma {error['within_3sigma']:.1%} of the time")
    return f"{', '.join(parts)}, converged at {summary['converged_at_s']:.0f} s"
