"""summary.json: the performance of a flight, judged against the plant's truth."""

from dataclasses import dataclass, field
from typing import Any

from fsw.wire.messages import CLASSES, NAMES, SENDERS, CoilRefused, FswEvent, intact
from sim.audit.auditor import AuditReport
from sim.flight.isolations import isolated_unit
from sim.record.candump import LogEntry
from sim.record.run_record import FlightRecord
from sim.report.figures.performance import Performance
from sim.scenario.schema import Scenario

Json = dict[str, Any]

MAX_EVENTS = 200


@dataclass(slots=True)
class BusTally:
    """Refusals on the bus, the first events in full, and the units that were isolated, in that order."""

    epoch_us: int
    refused: int = 0
    events: list[Json] = field(default_factory=list)
    isolated: list[str] = field(default_factory=list)

    def take(self, entry: LogEntry) -> None:
        """Count one frame."""
        can_id = entry.frame.can_id
        if can_id == CoilRefused.ID:
            self.refused += 1
        elif NAMES.get(can_id, "").endswith("_EVENT") and intact(entry.frame):
            self._take_event(entry)

    def _take_event(self, entry: LogEntry) -> None:
        can_id = entry.frame.can_id
        values = CLASSES[can_id].decode(entry.frame.data)._asdict()
        if can_id == FswEvent.ID:
            unit = isolated_unit(values["event"], values["argument"])
            if unit is not None and unit not in self.isolated:
                self.isolated.append(unit)
        if len(self.events) < MAX_EVENTS:
            seconds = (entry.timestamp_us - self.epoch_us) / 1e6
            self.events.append(
                {
                    "t_s": seconds,
                    "node": SENDERS[can_id],
                    "event": values["event"],
                    "severity": values["severity"],
                    "argument": values["argument"],
                }
            )


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
        "min_gap_s": {"per_coil": audit.min_gap_per_coil_s, "any": audit.min_gap_any_s},
        "max_pulse_s": audit.max_pulse_s,
        "limits_ok": audit.ok,
    }
    summary |= performance.figures()
    summary["spin_radps"] = _spin(performance.spin(), audit)
    summary["isolated"] = tally.isolated
    summary["events"] = tally.events
    return {key: value for key, value in summary.items() if value is not None}


def _spin(figures: Json | None, audit: AuditReport) -> Json | None:
    """With the pulses that were needed."""
    if figures is None or "settle_s_1e-3" not in figures:
        return figures
    return figures | {
        "pulses_to_settle": sum(pulse.start_s < figures["settle_s_1e-3"] for pulse in audit.pulses)
    }


def summary_text(summary: Json) -> str:
    """The summary as a few lines of text."""
    pulses, gap_s = summary["pulses"], summary["min_gap_s"]["any"]
    heading = f"{summary['scenario']}, seed {summary['seed']}: {summary['sim_seconds']:.0f} s flown"
    if "realtime_factor" in summary:
        heading += f" at {summary['realtime_factor']:.0f} times real time"
    limits_text = "kept" if summary["limits_ok"] else "BROKEN"
    limits = f"{limits_text}: {pulses['total']} pulses, {pulses['refused']} refused"
    if "max_pulse_s" in summary:
        limits += f", longest {summary['max_pulse_s']:.3f} s"
    if gap_s is not None:
        limits += f", least gap {gap_s:.3f} s"
    rows = {"limits": limits}
    if "pointing_deg" in summary:
        last = summary["pointing_deg"]
        rows["pointing"] = (
            f"{last['rms_last_orbit']:.2f} deg RMS, {last['max_last_orbit']:.2f} deg max over the last orbit"
        )
        axis1 = summary["axis1_deg"]
        settled = axis1.get("settle_orbits_5deg")
        after = f"under 5 deg from {settled:.2f} orbits on" if settled is not None else "not settled"
        rows["axis 1"] = f"{axis1['rms_last_orbit']:.2f} deg RMS off the vertical, {after}"
    if "spin_radps" in summary:
        spin = summary["spin_radps"]
        rows["spin"] = (
            f"{spin['mean_last_orbit']:.5f} rad/s in the mean of the last orbit, "
            f"{spin['max_dev_last_orbit']:.5f} at most off {spin['reference']:g}"
        )
    if "estimate_deg" in summary:
        error = summary["estimate_deg"]
        named = (("rms_sunlit", "RMS sunlit"), ("rms_eclipse", "RMS in eclipse"), ("max", "max"))
        parts = [f"{error[key]:.3f} deg {text}" for key, text in named if key in error]
        if error["within_3sigma"] is not None:
            parts.append(f"inside its 3 sigma {error['within_3sigma']:.1%} of the time")
        rows["estimate"] = f"{', '.join(parts)}, converged at {summary['converged_at_s']:.0f} s"
    if "mode_final" in summary:
        rows["mode"] = summary["mode_final"]
    rows["isolated"] = ", ".join(summary["isolated"]) or "no unit"
    if "replay" in summary:
        rows["replay"] = "bit-exact" if summary["replay"]["bit_exact"] else "NOT bit-exact"
    failed = summary.get("failures", {})
    rows |= {
        name.replace("_", " "): failed[name] for name in ("second_senders", "complete") if name in failed
    }
    return "\n".join([heading, *(f"  {name:<10} {text}" for name, text in rows.items())])
