"""summary.json: the performance of a flight, judged against the plant's truth."""

from dataclasses import dataclass, field

from fsw.wire.messages import CLASSES, NAMES, SENDERS, CoilRefused, FswEvent, intact
from sim.audit.auditor import AuditReport
from sim.audit.findings import DipoleCount
from sim.flight.isolations import isolated_unit, readmitted_unit
from sim.record.candump import LogEntry
from sim.record.run_record import FlightRecord
from sim.report.event_words import event_names, in_words
from sim.report.figures.performance import Performance
from sim.scenario.schema import Scenario
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
