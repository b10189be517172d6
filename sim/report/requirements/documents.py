"""The verdicts of a flight as tests of JUnit."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from sim.junit import JunitCase
from sim.report.requirements.judge import Outcome
from sim.report.verdict import Verdict
from sim.scenario.requirements import in_words

_NAMES = {
    Verdict.LIMITS: "limits of the coils",
    Verdict.REPLAY: "replay exact",
    Verdict.SECOND_SENDERS: "no second sender",
    Verdict.COMPLETE: "run complete",
}


def suites(summary: Mapping[str, Any]) -> dict[str, list[JunitCase]]:
    """What a run is judged by, and its requirements where it has some, from the content of summary.json."""
    failures = summary.get("failures", {})
    flight = [
        JunitCase("flight", name, failure=failures.get(verdict, "")) for verdict, name in _NAMES.items()
    ]
    flown_s = summary.get("wall_seconds") or 0.0
    requirements = requirement_cases(summary.get("requirements", ()), flown_s)
    return {"flight": flight, **({"requirements": requirements} if requirements else {})}


def requirement_cases(requirements: Iterable[Mapping[str, Any]], flown_s: float) -> list[JunitCase]:
    """Requirements with their outcomes, as in summary.json, of a flight that took so long."""
    return [_requirement(number, one, flown_s) for number, one in enumerate(requirements)]


def _requirement(number: int, one: Mapping[str, Any], flown_s: float) -> JunitCase:
    """Its time is that of the flight, which is what it takes to judge it."""
    why = "; ".join([str(one["text"]), *(str(reason["text"]) for reason in one["reasons"])])
    outcome = Outcome(one["verdict"])
    return JunitCase(
        "flight.requirements",
        _name(number, one),
        flown_s,
        failure=why if outcome is Outcome.FAILED else "",
        skipped=why if outcome is Outcome.NOT_JUDGED else "",
        properties=tuple(_evidence(one)),
    )


def _name(number: int, one: Mapping[str, Any]) -> str:
    if one.get("id") is None:
        return f"requirement {number + 1}"
    return in_words(one["index"], one["what"], one["id"])


def _evidence(one: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """What the verdict rests on, as far as there is any."""
    for key in ("measured", "limit", "unit", "window", "by_orbit", "verdict"):
        if one.get(key) is not None:
            yield key, str(one[key])
    if one["reasons"]:
        yield "reasons", "; ".join(str(reason["text"]) for reason in one["reasons"])
