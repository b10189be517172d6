"""summary.json: the performance of a flight, judged against the plant's truth."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from fsw.wire.messages import CLASSES, NAMES, SENDERS, CoilRefused, FswEvent, intact
from sim.audit.auditor import AuditReport
from sim.audit.findings import DipoleCount
from sim.record.candump import LogEntry
from sim.record.run_record import FlightRecord
from sim.report.event_words import event_names, events_left_out, in_words, isolated_unit, readmitted_unit
from sim.report.figures.performance import Performance
from sim.report.requirements.judge import Outcome
from sim.scenario.controlled import SLOW_DEGPS
from sim.scenario.schema import Scenario
from sim.statistics.settling import HELD_S
from sim.value_types import Json

MAX_EVENTS = 200
"""Events that are kept in full, the first ones."""


@dataclass(slots=True)
class BusTally:
    """Refusals on the bus, the first events and the number of all, and the units that were isolated."""

    epoch_us: int
    refused: int = 0
    events: list[Json] = field(default_factory=list)
    isolated: list[str] = field(default_factory=list)
    """In the order of their first isolation."""
    out_of_use: dict[str, float] = field(default_factory=dict)
    """The units that are isolated now, and since when, s."""
    event_count: int = 0

    def take(self, entry: LogEntry) -> None:
        """Count one frame."""
        can_id = entry.frame.can_id
        if can_id == CoilRefused.ID:
            self.refused += intact(entry.frame)
        elif NAMES.get(can_id, "").endswith("_EVENT") and intact(entry.frame):
            self._take_event(entry)

    def _take_event(self, entry: LogEntry) -> None:
        can_id = entry.frame.can_id
        values = CLASSES[can_id].decode(entry.frame.data).by_name()
        seconds = (entry.timestamp_us - self.epoch_us) / 1e6
        if can_id == FswEvent.ID:
            self._take_isolation(values["event"], values["argument"], seconds)
        self.event_count += 1
        if len(self.events) < MAX_EVENTS:
            self.events.append(_event(seconds, SENDERS[can_id], **values))

    def _take_isolation(self, event: int, argument: int, seconds: float) -> None:
        unit = isolated_unit(event, argument)
        if unit is not None:
            self.out_of_use.setdefault(unit, seconds)
            if unit not in self.isolated:
                self.isolated.append(unit)
        self.out_of_use.pop(readmitted_unit(event, argument) or "", None)


def _event(seconds: float, node: str, event: int, severity: int, argument: int, **_: int) -> Json:
    """An event with its names, and in words."""
    names = event_names(node, event, severity)
    stated = {
        "t_s": seconds,
        "node": node,
        "event": event,
        "name": names["name"],
        "severity": severity,
        "severity_name": names["severity_name"],
        "argument": argument,
    }
    return stated | {"text": in_words(stated).what}


def summarise(
    scenario: Scenario, run: FlightRecord, performance: Performance, audit: AuditReport, tally: BusTally
) -> Json:
    """The content of summary.json, of the keys that apply to this flight."""
    ticks = performance.ticks
    sim_s = ticks / scenario.time.tick_hz
    flight = run.get("flown")
    wall_s = flight.get("wall_s") if flight else None
    summary: Json = {
        "scenario": scenario.name,
        "seed": run["seed"],
        "sim_seconds": sim_s,
        "wall_seconds": wall_s,
        "realtime_factor": sim_s / wall_s if wall_s else None,
        "ticks": ticks,
        "slips": flight.get("slips") if flight else None,
        "pulses": {
            "total": len(audit.pulses),
            "per_coil": audit.pulses_per_coil,
            "refused": tally.refused,
        },
        "duty": {"per_coil": audit.duty_per_coil, "total": audit.duty_total},
        "min_gap_s": {
            "per_coil": audit.min_gap_per_coil_s,
            "any": audit.min_gap_any_s,
            "limited": audit.min_gap_limited_s,
        },
        "max_pulse_s": audit.max_pulse_s,
        "limits_ok": audit.ok,
        "dipoles": _dipoles(audit.dipoles),
    }
    summary |= performance.figures()
    summary["spin_radps"] = _spin(performance.spin(), audit)
    summary["requirements"] = performance.judgement.outcomes(audit, tally.out_of_use, "flown" in run)
    if "controlled" in summary and "flown" in run:
        settled = summary["controlled"].get("settle_orbits")
        summary["diagnosis"] = performance.judgement.diagnosis(settled, audit, tally.out_of_use)
    summary["isolated"] = tally.isolated
    summary["event_count"] = tally.event_count
    summary["events"] = tally.events
    return {key: value for key, value in summary.items() if value is not None}


def _dipoles(count: DipoleCount | None) -> Json | None:
    """What a continuous driver has driven; of a pulsed one nothing."""
    if count is None:
        return None
    return {"total": count.statuses, "per_coil": count.driven, "driven": count.any_driven}


def _spin(figures: Json | None, audit: AuditReport) -> Json | None:
    """With the pulses that were needed."""
    if figures is None or "settle_s_1e-3" not in figures:
        return figures
    return figures | {
        "pulses_to_settle": sum(pulse.start_s < figures["settle_s_1e-3"] for pulse in audit.pulses)
    }


# --- The summary of a flight as a few lines of text; that of an older version gives what it holds

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
