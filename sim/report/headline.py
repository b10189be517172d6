"""What the report says first: whether the requirements are met and why not, badges, the few main figures."""

from fsw.wire.messages import Mode
from sim.audit.auditor import AuditReport
from sim.drawing.page_parts import Table, Tile
from sim.flight.second_senders import describe_senders
from sim.record.run_record import RunRecord
from sim.report.requirements.judge import Outcome
from sim.report.summary_text import last_orbit
from sim.report.tables import has, value
from sim.value_types import Json

Badge = tuple[str, str]
"""A class of style, and the words."""

_TICK, _CROSS = "✓ ", "✗ "
_ESTIMATE = ("Attitude estimate", ("estimate_deg", "rms_sunlit"), "{:.3f}°", "RMS in sunlight")
_COILS = (
    ("Duty", ("duty", "total"), "{:.2%}", "all coils, whole flight"),
    ("Pulses", ("pulses", "total"), "{:d}", "of all coils"),
)


def headline(summary: Json) -> Badge:
    """Whether the flight meets its requirements, in a sentence."""
    found = summary["requirements"]
    failed = [one for one in found if one["verdict"] == Outcome.FAILED]
    unjudged = [one for one in found if one["verdict"] == Outcome.NOT_JUDGED]
    if not found:
        return "note", "Not judged: the scenario has no requirements."
    if failed:
        several = f"{len(failed)} of {len(found)} requirements missed"
        return "bad", f"{several if len(failed) > 1 else 'Requirement missed'}: {failed[0]['text']}."
    if unjudged:
        return "note", f"Not judged: {unjudged[0]['text']}."
    return "good", f"Requirements met: all {len(found)}." if len(found) > 1 else f"Met: {found[0]['text']}."


def requirement_table(summary: Json) -> Table:
    """A row per requirement, with the causes of one that is missed."""
    rows = [
        (
            one["verdict"],
            one["text"],
            "; ".join(reason["text"] for reason in one["reasons"]).replace("m^2", "m²"),
        )
        for one in summary["requirements"]
    ]
    return Table(("verdict", "requirement", "why"), rows)


def diagnosis_table(summary: Json) -> Table:
    """What limits the pointing, if anything does, and a row for each thing that may; none of an older run."""
    found = summary.get("diagnosis", {"findings": {}, "reasons": []})
    rows = [("why not settled", reason["text"]) for reason in found["reasons"]]
    rows += found["findings"].items()
    return Table(("", "what the flight shows"), [(name, text.replace("m^2", "m²")) for name, text in rows])


def badges(summary: Json, run: RunRecord | None, audit: AuditReport) -> list[Badge]:
    """The verdicts: requirements, limits, refusals, replay, mode, isolation, completeness.

    A good one is green only in a flight that meets its requirements, all of which were judged.
    """
    kind, words = headline(summary)
    sign = {"good": _TICK, "bad": _CROSS, "note": "! "}[kind]
    shown = [_limits_badge(audit)]
    refused = summary["pulses"]["refused"]
    shown.append(("note", f"! {refused} refused") if refused else ("good", f"{_TICK}no refusals"))
    shown.append(_replay_badge(summary.get("replay")))
    mode = summary.get("mode_final")
    if mode is not None:
        shown.append(("good" if mode == Mode.POINT.name else "note", f"mode {mode}"))
    if summary["isolated"]:
        shown.append(("note", f"! isolated: {', '.join(summary['isolated'])}"))
    if not whole(run, audit):
        planned = f" of {run['ticks']}" if run else ""
        shown.append(("bad", f"{_CROSS}incomplete: {summary['ticks']}{planned} ticks"))
    if summary.get("second_senders"):
        shown.append(("bad", f"{_CROSS}{describe_senders(summary['second_senders'])}"))
    if kind != "good":
        shown = [
            ("plain", text.removeprefix(_TICK)) if good == "good" else (good, text) for good, text in shown
        ]
    return [(kind, sign + words.partition(":")[0].lower()), *shown]


def whole(run: RunRecord | None, audit: AuditReport) -> bool:
    """The flight ran to its end, and its log is whole."""
    return audit.complete and (run is None or "flown" in run)


def tiles(summary: Json) -> list[Tile]:
    """The few figures that are looked at first; of the attitude, what is controlled."""
    rows = [*_controlled(summary), _ESTIMATE, *_COILS]
    return [
        Tile(name, value(summary, keys, pattern), note)
        for name, keys, pattern, note in rows
        if has(summary, keys)
    ]


def _controlled(summary: Json) -> list[tuple[str, tuple[str, ...], str, str]]:
    if "controlled" not in summary:
        return []
    found, note = summary["controlled"], f"RMS, {last_orbit(summary).removeprefix('the ')}"
    axis1 = ("Axis 1 from vertical", ("axis1_deg", "rms_last_orbit"), "{:.2f}°", note)
    settling = (
        "Settled",
        ("controlled", "settle_orbits"),
        "{:.2f}",
        f"orbits to {found['words']} under {found['threshold']:g} {found['unit']}",
    )
    first = {
        "attitude": [("Pointing", ("pointing_deg", "rms_last_orbit"), "{:.2f}°", note), axis1],
        "axis": [axis1],
        "rate": [("Rate", ("controlled", "rms_last_orbit"), "{:.4f} °/s", note)],
    }
    spin = ("Spin", ("spin_radps", "mean_last_orbit"), "{:.5f}", "rad/s, mean")
    return [*first[found["what"]], spin, settling]


def _limits_badge(audit: AuditReport) -> Badge:
    if audit.ok:
        return "good", f"{_TICK}limits kept"
    if not audit.violations:
        return "note", "! limits not judged: no coil status"
    return "bad", f"{_CROSS}limits broken: {len(audit.violations)}"


def _replay_badge(replay: Json | None) -> Badge:
    if replay is None:
        return "note", "not replayed"
    if replay["bit_exact"]:
        return "good", f"{_TICK}replay bit-exact"
    if replay["command_exact"]:
        return "note", "! replay command-exact only"
    return "bad", f"{_CROSS}replay differs"
