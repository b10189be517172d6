"""The command ``torquer judge``."""

from pathlib import Path

from sim.console import answer, fail, say
from sim.flight.record_flight import ticks_of
from sim.judge.flight import JudgedFlight, SoftwareUnderTest, fly_and_judge
from sim.judge.render import failed_text, verdict_json, verdict_page, verdict_suites, verdict_text
from sim.junit import write_junit
from sim.progress import progress
from sim.record import run_dir
from sim.result_files import write_result
from sim.scenario.schema import Scenario

PAGE, VERDICT = "judge.html", "judge.json"


def judge_scenario(
    software: SoftwareUnderTest,
    scenario: Scenario,
    seed: int,
    orbits: float | None,
    out: Path | None,
    junit: Path | None,
) -> int:
    """Fly one scenario against the flight software and say what is judged: the exit code.

    Raises:
        HarnessError: nothing can be flown.
        BusError: the bus cannot be used.
    """
    with progress(f"flying {scenario.name}", ticks_of(scenario, orbits)) as watch:
        flight = fly_and_judge(software, scenario, seed, out, orbits, watch)
    say(verdict_text(flight), failed=not flight.ok)
    write_judgement(flight)
    say(f"page: {flight.path / PAGE}")
    answer(verdict_json(flight) | {"page": flight.path / PAGE})
    write_junit(junit, "torquer judge", verdict_suites(flight))
    if not flight.ok:
        fail(failed_text(flight))
    return int(not flight.ok)


def write_judgement(flight: JudgedFlight) -> None:
    """Write page and verdicts into the run directory."""
    write_result(flight.path / PAGE, verdict_page(flight))
    run_dir.write_json(flight.path / VERDICT, {**verdict_json(flight), "run": str(flight.path)})
