"""Fly satellites of the population with one cause each, and look which cause their diagnosis names."""

import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import chain
from typing import NamedTuple

from fsw.input.schema import Nested, merge
from sim.campaign import population
from sim.campaign.flight import record_scenario
from sim.scenario.schema import load, parse_settings

FIRST, MOST = 761, 20
"""Seeds of the 50 kg population that no bound was chosen by."""


class Planted(NamedTuple):
    """A cause: the settings that plant it, and the length of the flight.

    ``also``: what else is true of it then; ``or_else``: what says the same.
    """

    settings: tuple[str, ...]
    orbits: float
    also: frozenset[str] = frozenset()
    or_else: str = ""


TURNED = ("body.inertia_kgm2=[1.95,1.85,1.02]", "flight.body.inertia_kgm2=[1.95,1.85,1.02]")
MISLED = frozenset({"estimate", "mismatch"})
"""What is beyond the table's bounds misleads the filter."""
PLANTED = {
    "": Planted((), 8.0),
    "gravity": Planted((*TURNED, "initial.angle_deg=60"), 5.0),
    "weak": Planted(
        ("coils.levels_am2=[0.03,0.08,0.2]", "coils.dipole_per_ampere_am2=0.5"), 5.0, or_else="disturbance"
    ),
    "coarse": Planted(("coils.levels_am2=[20.0,30.0,40.0]",), 5.0),
    "disturbance": Planted(("disturbance.residual_dipole_am2=[0.3,0.3,0.3]",), 4.0, MISLED | {"any_law"}),
    "any_law": Planted(("disturbance.torque_nm=[4e-7,4e-7,4e-7]",), 4.0, MISLED | {"disturbance"}),
    "unstable": Planted(("control.law=pd", "control.k_a=1e8"), 4.0),
    "isolated": Planted(('fault=[{kind="mag_nan",at_s=1000.0}]',), 3.0),
    "safe": Planted(('telecommand=[{message="TC_MODE",mode="SAFE",at_s=300.0}]',), 3.0),
    "tumbling": Planted(("initial.rate_degps=[4,4,4]",), 1.6),
    "dark": Planted(('time.epoch_utc="2015-03-27T03:25:00Z"',), 0.3),
    "estimate": Planted(("sensors.sun.misalignment_deg=[15.0,0,0]",), 3.0, frozenset({"mismatch"})),
    "short": Planted((), 0.3),
}
"""By the cause that should be named; none of a sound satellite."""


class Case(NamedTuple):
    """One flight."""

    cause: str
    satellite: int


def named(case: Case) -> tuple[Case, tuple[str, ...]]:
    """The causes that the diagnosis of this flight names."""
    planted = PLANTED[case.cause]
    settings: Nested = merge(population.satellite("50kg", case.satellite), parse_settings(planted.settings))
    record = record_scenario(load("microsat", settings), case.satellite, planted.orbits)
    return case, tuple(reason["cause"] for reason in record.summary()["diagnosis"]["reasons"])


def table(found: list[tuple[Case, tuple[str, ...]]]) -> Iterator[str]:
    """A row a cause: how often it is named, and what is wrong instead or beside it."""
    yield "| planted | flights | named | a wrong one | which |"
    yield "|---|---|---|---|---|"
    for cause, planted in PLANTED.items():
        reasons = [causes for case, causes in found if case.cause == cause]
        names = {cause, planted.or_else} - {""}
        right = sum(bool(names & set(causes)) if cause else not causes for causes in reasons)
        wrong = [sorted(set(causes) - names - planted.also) for causes in reasons]
        counted = Counter(chain.from_iterable(wrong)).most_common()
        which = ", ".join(f"{name} {count}" for name, count in counted)
        yield f"| {cause or 'nothing'} | {len(reasons)} | {right} | {sum(map(bool, wrong))} | {which} |"


def main() -> None:
    """Fly them all, or so many satellites as are asked for, and print the table."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else MOST
    cases = [Case(cause, FIRST + number) for cause in PLANTED for number in range(count)]
    found = []
    with ProcessPoolExecutor() as pool:
        for number, one in enumerate(pool.map(named, cases), 1):
            found.append(one)
            print(f"\r{number} of {len(cases)} flights", end="", file=sys.stderr, flush=True)
    print("\n".join(("", *table(found))))


if __name__ == "__main__":
    main()
