"""The verdicts of a flight as tests of JUnit."""

from collections.abc import Mapping
from typing import Any

from sim.junit import JunitCase
from sim.report.requirements.judge import Outcome
from sim.report.verdict import Verdict

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
    requirements = [_requirement(number, one) for number, one in enumerate(summary.get("requirements", ()))]
    return {"flight": flight, **({"requirements": requirements} if requirements else {})}


def _requirement(number: int, one: Mapping[str, Any]) -> JunitCase:
    why = "; ".join([str(one["text"]), *(str(reason["text"]) for reason in one["reasons"])])
    outcome = Outcome(one["verdict"])
    return JunitCase(
        "flight.requirements",
        f"requirement {number + 1}",
        failure=why if outcome is Outcome.FAILED else "",
        skipped=why if outcome is Outcome.NOT_JUDGED else "",
    )
