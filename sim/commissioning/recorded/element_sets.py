"""Of a file of element sets the one nearest in time."""

from pathlib import Path
from typing import NamedTuple

from fsw.core.orbit.propagation import TleOrbit, sgp4_orbit
from fsw.core.orbit.tle import tle_epoch_unix_s
from sim.errors import HarnessError
from sim.scenario.element_file import check_one_satellite, read_element_file

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
    found = read_element_file(path)
    check_one_satellite(path, found)
    epochs = [tle_epoch_unix_s(*one.lines) for one in found]
    number = min(range(len(found)), key=lambda one: abs(epochs[one] - unix_s))
    try:
        return ElementSet(sgp4_orbit(*found[number].lines), epochs[number])
    except ValueError as error:
        raise HarnessError(f"{path}: {found[number].where}: {error}") from None
