"""A file of two-line element sets, with or without names between them, and the one nearest in time."""

from pathlib import Path
from typing import NamedTuple

from fsw.core.orbit.propagation import TleOrbit, sgp4_orbit
from fsw.core.orbit.tle import tle_epoch_unix_s
from fsw.input.regular_file import read_regular
from sim.errors import HarnessError

MOST_BYTES = 20_000_000
DAY_S = 86400.0


class ElementSet(NamedTuple):
    """An orbit, and its epoch as Unix time."""

    orbit: TleOrbit
    epoch_unix_s: int

    def age_days(self, unix_s: float) -> float:
        """How old it is at a time."""
        return (unix_s - self.epoch_unix_s) / DAY_S


def nearest_elements(path: Path, unix_s: float) -> ElementSet:
    """The set of the file whose epoch is nearest to a time.

    Raises:
        HarnessError: the file cannot be read, holds no set, a malformed one, or sets of several satellites.
    """
    try:
        lines = read_regular(path, MOST_BYTES).decode("utf-8", errors="replace").splitlines()
    except OSError as error:
        raise HarnessError(f"{path}: cannot be read ({error.strerror or error})") from None
    pairs = _pairs(path, lines)
    satellites = sorted({first[2:7].strip() for _, first, _ in pairs})
    if not pairs:
        raise HarnessError(f"{path}: there is no two-line element set in it")
    if len(satellites) > 1:
        raise HarnessError(
            f"{path}: it holds sets of {len(satellites)} satellites ({', '.join(satellites[:4])}): keep one"
        )
    epochs = [_epoch(path, *pair) for pair in pairs]
    number = min(range(len(pairs)), key=lambda one: abs(epochs[one] - unix_s))
    line, first, second = pairs[number]
    try:
        return ElementSet(sgp4_orbit(first, second), epochs[number])
    except ValueError as error:
        raise HarnessError(f"{path}: line {line}: {error}") from None


def _pairs(path: Path, lines: list[str]) -> list[tuple[int, str, str]]:
    """Number of the first line, and both lines, of each set."""
    pairs, number = [], 0
    while number < len(lines):
        if lines[number].startswith("1 ") and len(lines[number].rstrip()) == 69:
            if number + 1 == len(lines) or not lines[number + 1].startswith("2 "):
                raise HarnessError(f"{path}: after line {number + 1} its second element line is missing")
            pairs.append((number + 1, lines[number], lines[number + 1]))
            number += 1
        elif lines[number].startswith(("1 ", "2 ")) and len(lines[number].split()) > 6:
            raise HarnessError(f"{path}: line {number + 1} is no element line of 69 characters in its place")
        number += 1
    return pairs


def _epoch(path: Path, line: int, first: str, second: str) -> int:
    try:
        return tle_epoch_unix_s(first, second)
    except ValueError as error:
        raise HarnessError(f"{path}: line {line}: {error}") from None
