"""``torquer design --laws``: the best gains of each law on a body, kept as they are found."""

import os
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from fsw.core.laws.table import LAWS
from fsw.input.near import did_you_mean
from fsw.input.schema import Nested, merge
from fsw.table.sections import laws_by_aim
from sim.campaign.claim import Study
from sim.campaign.runner import StudyResult, run
from sim.campaign.study_cache import with_cache
from sim.console import counted, say
from sim.errors import HarnessError
from sim.progress import progress
from sim.scenario.schema import Scenario, load, shipped_names
from sim.tuning.applicable import check_suited, coils_of, is_suited, laws_for
from sim.tuning.kept import KeptGains, body_checksum, gains_text, read_gains, write_gains
from sim.tuning.rigid_flight import STEP_S
from sim.tuning.search import BUDGET, ORBITS, SEED, TunedGains, confirm, tune

DRIVERS = ("pulsed", "continuous")
FASTEST_RAD = 0.4
"""By so much a body may turn in a step of a flight."""


def design_laws(
    name: str,
    over: Nested,
    laws: str,
    path: Path | None,
    flights: int | None = None,
    orbits: float = ORBITS,
    workers: int | None = None,
) -> KeptGains:
    """Search the gains of laws for a scenario, print them, and keep each in the file once it is found.

    A law that the file has is searched again only where whole flights no longer bear its gains out; a file
    for another body or by other rules is left alone.

    Args:
        name: of the scenario, or its path.
        over: laid over it.
        laws: names with commas between, or ``all`` that suit the body.
        path: the file; None: ``<scenario>-gains.toml``.
        flights: for each law; None: ``BUDGET``.
        orbits: length of each flight.
        workers: processes, each of which searches a law; None: as many as there are cores.

    Raises:
        TableError: the scenario is not valid, or has not what a law needs.
        HarnessError: there is no such law, or the file cannot be read or written, or holds something else.
    """
    scenario, budget = load(name, over), flights or BUDGET
    chosen = _chosen(scenario, laws)
    check_suited(chosen, name, over)
    path = path or Path(f"{scenario.name}-gains.toml")
    empty = KeptGains(body_checksum(scenario), budget, orbits)
    kept = read_gains(path) or empty
    if replace(kept, rows={}) != empty:
        raise HarnessError(
            f"{path}: holds gains of another body, start or coils, or by {kept.flights} flights of "
            f"{kept.orbits:g} orbits and seed {kept.seed} instead of {budget} of {orbits:g} and {SEED}: "
            "give --keep another file"
        )
    wanted = [(driver, law) for driver in DRIVERS for law in chosen if is_suited(law, scenario, driver)]
    rules = (budget, orbits, step_s(scenario))
    searches = []
    for driver, law in wanted:
        over_law, row = merge(over, coils_of(scenario, driver)), kept.rows.get(driver, {}).get(law)
        searches.append(
            partial(tune, name, over_law, law, *rules)
            if row is None
            else partial(confirm, name, over_law, law, row["control"], row["cost"], *rules)
        )
    studies = [
        Study(f"{law}, {driver}", (search,), lambda found: [], has_flights=True)
        for (driver, law), search in zip(wanted, searches, strict=True)
    ]
    if name in shipped_names() and not over:  # else a file of the user's may be part of it
        studies = with_cache(studies)

    def keep(finished: StudyResult) -> None:
        nonlocal kept
        found = finished.results[0]
        before = kept.rows.get(found.driver, {}).get(found.law)
        if found.flights:
            kept = kept.with_row(found)
            write_gains(path, kept)
        say(line(found, None if before is None else before["cost"]))

    with progress(f"gains of {counted(len(chosen), 'law')} for {scenario.name}", len(wanted)) as watch:
        run(studies, workers or os.cpu_count() or 1, watch, keep)
    say(f"gains: {path}")
    return kept


def step_s(scenario: Scenario) -> float:
    """The steps of the flights: shorter for a body that spins."""
    spin = abs(scenario.control.spin_radps)
    return STEP_S if spin == 0.0 else max(2.0, min(STEP_S, 2.0 * (FASTEST_RAD / spin // 2.0)))


def line(found: TunedGains, earlier: float | None = None) -> str:
    """One law for the terminal; ``earlier`` is what the gains cost that the file had of it."""
    settled = found.cost.settle_orbits
    when = "never settled" if settled is None else f"settled after {settled:.2f} orbits"
    gains = gains_text(found.control)
    if earlier is None:
        origin = ""
    elif found.flights == 0:
        origin = "; the file's, borne out"
    else:
        origin = f"; searched again, as the file's cost {earlier:.3f} no longer"
    return (
        f"{found.law}, {found.driver}: {when}, then {found.cost.rms:.3g} RMS; cost {found.cost.total:.3f}, "
        f"before {found.before.total:.3f}; {gains}{origin}"
    )


def _chosen(scenario: Scenario, laws: str) -> Sequence[str]:
    if laws == "all":
        return laws_for(scenario)
    words = list(dict.fromkeys(word.strip() for word in laws.split(",")))
    for word in words:
        if word not in LAWS:
            raise HarnessError(
                f"--laws {laws}: there is no law '{word}'{did_you_mean(word, LAWS)}: give all, or names "
                f"(docs/laws.md); {laws_by_aim({name: entry.aim for name, entry in LAWS.items()})}"
            )
    return words
