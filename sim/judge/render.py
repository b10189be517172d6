"""The verdicts of a flight against a user's flight software: as text, page, JSON and JUnit."""

from collections.abc import Iterator, Sequence

from sim.console import counted
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.judge.flight import JudgedFlight
from sim.judge.invariants import RULES
from sim.junit import JunitCase
from sim.record import run_dir
from sim.report.requirements.documents import requirement_cases
from sim.report.requirements.judge import Outcome
from sim.result_files import write_result
from sim.value_types import Json

PAGE, VERDICT = "judge.html", "judge.json"
_HEADS = {Outcome.MET: "kept", Outcome.FAILED: "BROKEN", Outcome.NOT_JUDGED: "not judged"}
_OF_REQUIREMENTS = {Outcome.MET: "met", Outcome.FAILED: "FAILED", Outcome.NOT_JUDGED: "not judged"}


def verdict_text(flight: JudgedFlight) -> str:
    """A line for each verdict, what is wrong first."""
    run = flight.record.run
    head = f"{run['scenario']}, seed {run['seed']}, profile {flight.record.profile.value}: "
    head += f"{counted(flight.record.answers.ticks, 'tick')} flown against {software_text(flight)}"
    lines = list(_lines(flight))
    width = max(len(name) for name, _ in lines)
    return "\n".join([head, *(f"  {name:<{width}} {text}" for name, text in lines)])


def _lines(flight: JudgedFlight) -> Iterator[tuple[str, str]]:
    broken = [one for one in flight.invariants if one.outcome is Outcome.FAILED]
    others = [one for one in flight.invariants if one.outcome is not Outcome.FAILED]
    for rule in broken:
        yield rule.name, f"{_HEADS[rule.outcome]}: {rule.text}"
    for reason in flight.reasons:
        yield "why", reason
    for one in flight.requirements:
        yield "required", f"{_OF_REQUIREMENTS[Outcome(one['verdict'])]}: {one['text']}"
        for reason in one["reasons"]:
            yield "", f"- {reason['text']}"
    for rule in sorted(others, key=lambda one: one.outcome is Outcome.NOT_JUDGED):
        yield rule.name, f"{_HEADS[rule.outcome]}: {rule.text}"


def software_text(flight: JudgedFlight) -> str:
    """The flight software in words."""
    command = flight.record.run.get("flight_software", {}).get("command")
    return f"what runs on {flight.record.run['bus']}" if command is None else str(command)


def failed_clauses(flight: JudgedFlight) -> list[str]:
    """What is broken or missed, a clause each; empty of a flight that is as it should be."""
    clauses = [f"{one.name}: {one.text}" for one in flight.invariants if one.outcome is Outcome.FAILED]
    return clauses + [
        f"missed: {one['text']}" for one in flight.requirements if one["verdict"] == Outcome.FAILED.value
    ]


def failed_text(flight: JudgedFlight) -> str:
    """All that is broken or missed, in one sentence; empty of a flight that is as it should be."""
    clauses = failed_clauses(flight)
    if not clauses:
        return ""
    more = f", and {len(clauses) - 1} more" if len(clauses) > 1 else ""
    why = f" ({flight.reasons[0]})" if flight.reasons else ""
    return f"the flight software failed: {clauses[0]}{why}{more}"


def verdict_json(flight: JudgedFlight) -> Json:
    """The verdicts as values."""
    return {
        "run": flight.path,
        "ok": flight.ok,
        "profile": flight.record.profile.value,
        "software": software_text(flight),
        "ticks": flight.record.answers.ticks,
        "invariants": [
            {"name": one.name, "verdict": _HEADS[one.outcome].lower(), "text": one.text}
            for one in flight.invariants
        ],
        "requirements": flight.requirements,
        "reasons": flight.reasons,
    }


def verdict_suites(flight: JudgedFlight) -> dict[str, list[JunitCase]]:
    """The verdicts as tests of JUnit."""
    wall_s = flight.record.summary.get("wall_seconds") or 0.0
    rules = [
        JunitCase(
            "flight.invariants",
            one.name,
            wall_s,
            failure=one.text if one.outcome is Outcome.FAILED else "",
            skipped=one.text if one.outcome is Outcome.NOT_JUDGED else "",
        )
        for one in flight.invariants
    ]
    required = requirement_cases(flight.requirements, wall_s)
    return {"invariants": rules, **({"requirements": required} if required else {})}


def verdict_page(flight: JudgedFlight) -> str:
    """The page of a flight."""
    record, summary = flight.record, flight.record.summary
    badge = ("good", "✓ as it should be") if flight.ok else ("bad", f"✗ {_count_failed(flight)} failed")
    facts = (
        software_text(flight),
        f"profile {record.profile.value}",
        f"seed {record.run['seed']}",
        f"{record.run['pace']} on {record.run['bus']}",
        f"torquer {record.run['torquer_version']}",
    )
    tiles = [Tile("Ticks", str(record.answers.ticks), "flown")]
    if "pulses" in summary:
        tiles += [
            Tile("Pulses", str(summary["pulses"]["total"]), "of all coils"),
            Tile("Refused", str(summary["pulses"]["refused"]), "by the coil board"),
        ]
    sections = [
        PageSection("rules", "What every flight software keeps", tables=(rule_table(flight),)),
        PageSection("requirements", "Requirements", tables=(_requirement_table(flight),)),
    ]
    if flight.reasons:
        why = " ".join(f"{reason[:1].upper()}{reason[1:]}." for reason in flight.reasons)
        sections.insert(0, PageSection("why", "Why", note=why))
    if (flight.path / run_dir.REPORT).is_file():
        note = f"Charts of the flight are in {run_dir.REPORT} beside this page."
        sections.append(PageSection("more", "The flight", note=note))
    return sections_page(PageHeader("Judgement", record.run["scenario"], facts, [badge], tiles), sections)


def rule_table(flight: JudgedFlight) -> Table:
    """A row per rule, with what it demands."""
    demands = {name: (rule.__doc__ or "").strip() for name, rule in RULES.items()}
    rows = [
        (_HEADS[one.outcome], one.name, one.text, demands.get(one.name, "Of the profile detumble."))
        for one in flight.invariants
    ]
    return Table(("verdict", "rule", "found", "demands"), rows)


def _requirement_table(flight: JudgedFlight) -> Table:
    rows = [
        (
            _OF_REQUIREMENTS[Outcome(one["verdict"])],
            one["text"],
            "; ".join(reason["text"] for reason in one["reasons"]).replace("m^2", "m²"),
        )
        for one in flight.requirements
    ]
    return Table(("verdict", "requirement", "why"), rows)


def write_judgement(flight: JudgedFlight) -> None:
    """Write page and verdicts into the run directory."""
    write_result(flight.path / PAGE, verdict_page(flight))
    run_dir.write_json(flight.path / VERDICT, {**verdict_json(flight), "run": str(flight.path)})


def _count_failed(flight: JudgedFlight) -> int:
    missed: Sequence[Json] = [one for one in flight.requirements if one["verdict"] == Outcome.FAILED.value]
    return len(missed) + sum(one.outcome is Outcome.FAILED for one in flight.invariants)
