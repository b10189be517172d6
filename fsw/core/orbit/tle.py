"""Two-line element sets: the one place that checks their format. The numbers are read by ``sgp4`` alone."""

import re
from math import degrees, pi
from typing import Final

from sgp4.api import Satrec
from sgp4.io import compute_checksum

from fsw.core.orbit.elements import Elements

DAY_S: Final = 86400
DAY_MIN: Final = 1440.0
UNIX_EPOCH_JD: Final = 2440587.5
"""1970-01-01 as a Julian date."""

_SATELLITE = r"(?P<satellite>[ 0-9A-Z][ 0-9]{4})"
_ANGLE = r"(?:[0-9]{3}| [0-9]{2}|  [0-9])\.[0-9]{4}"
_EXPONENTIAL = r"[ +-][0-9]{5}[+-][0-9]"
_COUNT = r" *[0-9]+"
_LINE_1 = re.compile(
    rf"(?=.{{69}}$)1 {_SATELLITE}[A-Z] [ 0-9A-Z]{{8}} (?P<year>[0-9]{{2}})(?P<day>[0-9]{{3}})\.[0-9]{{8}}"
    rf" [ +-]\.[0-9]{{8}}"
    rf" {_EXPONENTIAL} {_EXPONENTIAL} [ 0-9] {_COUNT}"
)
_LINE_2 = re.compile(
    rf"(?=.{{69}}$)2 {_SATELLITE} {_ANGLE} {_ANGLE} [0-9]{{7}} {_ANGLE} {_ANGLE}"
    rf" (?:[0-9]{{2}}| [0-9])\.[0-9]{{8}}{_COUNT}"
)


def plain_line(line: str) -> str:
    """An element line with common blanks for those of any kind, capitals, and no blanks after it."""
    return "".join(" " if letter.isspace() else letter for letter in line).upper().rstrip()


def read_tle(line1: str, line2: str) -> Satrec:
    """The element set; blanks and line ends after the lines are ignored.

    Raises:
        ValueError: a line is malformed or its checksum wrong, the year has no such day, or the lines are of
            two satellites.
    """
    line1, line2 = line1.rstrip(), line2.rstrip()
    first, second = _checked(line1, 1, _LINE_1), _checked(line2, 2, _LINE_2)
    if first["satellite"] != second["satellite"]:
        raise ValueError(
            f"the element lines are of two satellites, {first['satellite']} and {second['satellite']}"
        )
    days = 366 if int(first["year"]) % 4 == 0 else 365
    if int(first["day"]) > days:
        raise ValueError(
            f"element line 1 has day {first['day']} of the year, and year {first['year']} has {days}: "
            f"{line1!r}"
        )
    return Satrec.twoline2rv(line1, line2)


def tle_elements(line1: str, line2: str) -> Elements:
    """The elements, each the float nearest to the decimal number in its column.

    ``sgp4`` holds angles in rad and the motion in rad/min: rounding to the decimals of the column undoes what
    the conversion has cost.

    Raises:
        ValueError: as in ``read_tle``.
    """
    satellite = read_tle(line1, line2)
    return Elements(
        epoch_day=satellite.jdsatepoch - UNIX_EPOCH_JD,
        epoch_fraction=round(satellite.jdsatepochF, 8),
        inclination_deg=_degrees(satellite.inclo),
        raan_deg=_degrees(satellite.nodeo),
        eccentricity=satellite.ecco,
        perigee_deg=_degrees(satellite.argpo),
        anomaly_deg=_degrees(satellite.mo),
        motion_revpday=round(satellite.no_kozai * DAY_MIN / (2.0 * pi), 8),
        bstar=float(f"{satellite.bstar:.4e}"),
    )


def tle_epoch_unix_s(line1: str, line2: str) -> int:
    """The epoch, rounded up to a whole second.

    Raises:
        ValueError: as in ``read_tle``.
    """
    elements = tle_elements(line1, line2)
    parts = round(elements.epoch_fraction * 1e8)  # an integer, so that a whole second is not rounded up
    return round(elements.epoch_day) * DAY_S - (-parts * DAY_S // 10**8)


def _checked(line: str, number: int, form: re.Pattern[str]) -> re.Match[str]:
    """The parts of a line that is sound."""
    found = form.fullmatch(line)
    if not found:
        raise ValueError(f"element line {number} is not in the two-line format: {line!r}")
    checksum = compute_checksum(line)
    if checksum != int(line[-1]):
        raise ValueError(f"element line {number} has checksum {line[-1]} but adds up to {checksum}: {line!r}")
    return found


def _degrees(angle_rad: float) -> float:
    return round(degrees(angle_rad), 4)
