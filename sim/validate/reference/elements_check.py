"""tle.txt: real elements through the onboard orbit and the plant's."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fsw.core.orbit.propagation import sgp4_orbit, state_eci
from fsw.core.orbit.tle import read_tle, tle_elements, tle_epoch_unix_s
from sim.campaign.claim import Claim, ClaimOutcome
from sim.errors import HarnessError
from sim.plant.environment.orbit import Sgp4Orbit
from sim.validate.reference.reference_table import read_lines

POSITION_M = 1e-3
VELOCITY_MPS = 1e-6
"""The same propagator; the two split the time into day and fraction differently."""
WIDE = "the two split a time differently: 1e-12 days are 0.6 mm"
SPAN_S, STEP_S = 86400, 60
SLOWEST_REVOLUTIONS_A_DAY = 6.4
"""225 minutes: SGP4 uses another theory for slower orbits, which this project does not cover."""


@dataclass(frozen=True, slots=True)
class NamedElements:
    """A two-line element set, and the line of the file that it begins in."""

    name: str
    lines: tuple[str, str]
    line: int

    @property
    def title(self) -> str:
        """The name, or the number of the satellite where the file gives none."""
        return self.name or str(read_tle(*self.lines).satnum_str)


def check(path: Path) -> Iterator[ClaimOutcome]:
    """Compare position and velocity over a day from each epoch.

    Raises:
        HarnessError: the file holds no elements, or malformed ones.
    """
    found = [elements for elements in read_elements(path) if not _slow(path, elements)]
    if not found:
        raise HarnessError(f"{path}: no elements of an orbit under 225 minutes")
    distances = [_largest_distances(path, elements) for elements in found]
    names = [f"{path.name} line {elements.line} ({elements.title})" for elements in found]
    rows = (
        ("position", "Onboard SGP4 position against the plant's, one day", "m", POSITION_M),
        ("velocity", "Onboard SGP4 velocity against the plant's, one day", "m/s", VELOCITY_MPS),
    )
    for part, (name, statement, unit, tolerance) in enumerate(rows):
        claim = Claim(f"reference.tle.{name}", statement, path.name, unit, high=tolerance, wide=WIDE)
        worst = int(np.argmax([distance[part] for distance in distances]))
        yield claim.judge(distances[worst][part], names[worst])


def read_elements(path: Path) -> list[NamedElements]:
    """The element sets of a file: a name, then two lines; lines that begin with ``#`` do not count.

    Raises:
        HarnessError: a line is missing or not where it belongs.
    """
    lines = [(number, line.rstrip()) for number, line in read_lines(path)]
    lines = [(number, line) for number, line in lines if line and not line.startswith("#")]
    if not lines:
        raise HarnessError(f"{path}: no elements")
    found, name = [], ""
    while lines:
        number, line = lines.pop(0)
        if not line.startswith("1 "):
            if name or line.startswith("2 "):
                raise HarnessError(f"{path}, line {number}, column 1: element line 1 is missing before it")
            name = line
            continue
        if not lines or not lines[0][1].startswith("2 "):
            raise HarnessError(f"{path}, line {number}: element line 2 does not follow")
        found.append(NamedElements(name, (line, lines.pop(0)[1]), number))
        name = ""
    if name:
        raise HarnessError(f"{path}, line {number}: no elements follow the name {name}")
    return found


def _slow(path: Path, elements: NamedElements) -> bool:
    try:
        return tle_elements(*elements.lines).motion_revpday < SLOWEST_REVOLUTIONS_A_DAY
    except ValueError as error:
        raise HarnessError(f"{path}, line {elements.line}: {error}") from None


def _largest_distances(path: Path, elements: NamedElements) -> tuple[float, float]:
    """Largest distances of position [m] and velocity [m/s]."""
    try:
        onboard = sgp4_orbit(*elements.lines)
        epoch_unix_s = tle_epoch_unix_s(*elements.lines)
        plant = Sgp4Orbit(elements.lines, epoch_unix_s)
        times = np.arange(0.0, SPAN_S + STEP_S, STEP_S)
        r_m, v_mps = plant.at(times)
    except ValueError as error:
        raise HarnessError(f"{path}, line {elements.line}: {error}") from None
    states = [state_eci(onboard, epoch_unix_s + t) for t in times.tolist()]
    if any(state is None for state in states):
        raise HarnessError(
            f"{path}, line {elements.line}: the onboard orbit of {elements.title} ends within a day"
        )
    ours = np.array(states)
    deviations = np.linalg.norm(ours - np.stack([r_m, v_mps], axis=1), axis=2).max(axis=0)
    return float(deviations[0]), float(deviations[1])
