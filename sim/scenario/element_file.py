"""Files of element sets: two lines with or without a name, or OMM (CCSDS 502.0-B) as JSON, XML, CSV or KVN.

An OMM becomes two lines: its epoch is rounded to 1e-8 days (0.4 ms, 3 m), its numbers to the digits of the
lines, and a catalogue number that the lines cannot hold to 0. SGP4 does not use the derivatives of the mean
motion; they become 0.
"""

import csv
import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime, timedelta
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from sgp4.io import compute_checksum

from fsw.core.orbit.propagation import TleOrbit, sgp4_orbit
from fsw.core.orbit.tle import plain_line, read_tle, tle_elements, tle_epoch_unix_s
from fsw.input.text_file import read_text
from sim.errors import HarnessError, reading

MOST_BYTES = 20_000_000
LONGEST_NAME = 40
_KVN = re.compile(r"^\s*([A-Z_]+)\s*=\s*(.*?)\s*(?:\[.*\])?\s*$")
_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ"
"""Of alpha-5, the first digit of a catalogue number beyond 99999."""
_MOST_ALPHA_5 = 339_999
_DAY, _MICROSECOND = timedelta(days=1), timedelta(microseconds=1)


class FiledElements(NamedTuple):
    """A set of a file: the satellite's name, its two lines, and where in the file it begins."""

    name: str
    lines: tuple[str, str]
    where: str

    @property
    def satellite(self) -> str:
        """The catalogue number as the lines have it."""
        return self.lines[0][2:7].strip()

    @property
    def title(self) -> str:
        """Number and name."""
        return f"{self.satellite} {self.name}".strip()

    @property
    def epoch_day(self) -> float:
        """Days since 1970."""
        elements = tle_elements(*self.lines)
        return elements.epoch_day + elements.epoch_fraction


def read_element_file(path: Path) -> list[FiledElements]:
    """The sets of a file, in its order, each checked.

    Raises:
        HarnessError: the file cannot be read, holds no set, or a malformed one.
    """
    with reading(path):
        text = read_text(path, MOST_BYTES, odd_letters=True)
    try:
        found = list(_sets(text))
    except ValueError as error:
        raise HarnessError(f"{path}: {error}") from None
    if not found:
        raise HarnessError(f"{path}: there is no two-line element set in it, nor an OMM")
    return found


def check_one_satellite(path: Path, found: list[FiledElements]) -> None:
    """Check that all sets are of one satellite.

    Raises:
        HarnessError: they are of several, which it names.
    """
    titles = {one.satellite: one.title for one in reversed(found)}
    if len(titles) > 1:
        named = ", ".join(sorted(titles.values())[:4])
        raise HarnessError(f"{path}: it holds sets of {len(titles)} satellites ({named}): keep one")


def _sets(text: str) -> Iterator[FiledElements]:
    start = text.lstrip()[:1]
    first = next((line for line in text.splitlines() if line.strip()), "")
    messages: Iterable[Mapping[str, Any]] = ()
    if start in ("{", "["):
        messages = _json(text)
    elif start == "<":
        messages = _xml(text)
    elif "MEAN_MOTION" in first and "," in first:
        messages = _csv(text)
    elif any(match and match[1] == "MEAN_MOTION" for match in map(_KVN.match, text.splitlines())):
        messages = _kvn(text)
    else:
        yield from _two_lines(text.splitlines())
    for number, fields in enumerate(messages, start=1):
        yield _of_omm(number, fields)


def _csv(text: str) -> Iterator[Mapping[str, Any]]:
    try:
        yield from csv.DictReader(text.strip().splitlines())
    except csv.Error as error:
        raise ValueError(f"an OMM in CSV that cannot be read: {error}") from None


def _json(text: str) -> Iterator[Mapping[str, Any]]:
    try:
        values = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as error:
        raise ValueError(f"an OMM in JSON that cannot be read: {error}") from None
    for value in values if isinstance(values, list) else [values]:
        if not isinstance(value, dict):
            raise ValueError(
                "JSON, and no OMM: a message is an object of keys, such as EPOCH and MEAN_MOTION"
            )
        yield value


def _xml(text: str) -> Iterator[Mapping[str, Any]]:
    try:
        root = ET.fromstring(re.sub(r"^\s*<\?xml[^>]*\?>", "", text))
    except ET.ParseError as error:
        raise ValueError(f"an OMM in XML that cannot be read: {error}") from None
    segments = [node for node in root.iter() if _tag(node) == "segment"]
    if not segments:
        raise ValueError("XML, and no OMM: there is no segment in it")
    for segment in segments:
        yield {_tag(node): node.text or "" for node in segment.iter()}


def _tag(node: ET.Element) -> str:
    return node.tag.rpartition("}")[2]


def _kvn(text: str) -> Iterator[Mapping[str, Any]]:
    """Keys and values; a key that comes again begins the next message."""
    fields: dict[str, str] = {}
    for match in filter(None, map(_KVN.match, text.splitlines())):
        if match[1] in fields and match[1] != "COMMENT":
            yield fields
            fields = {}
        fields[match[1]] = match[2]
    yield fields


def _of_omm(number: int, fields: Mapping[str, Any]) -> FiledElements:
    where = f"message {number}"
    try:
        lines = omm_lines(fields)
        read_tle(*lines)
    except ValueError as error:
        raise ValueError(f"OMM, {where}: {error}") from None
    return FiledElements(_name(str(fields.get("OBJECT_NAME") or "")), lines, where)


def omm_lines(fields: Mapping[str, Any]) -> tuple[str, str]:
    """The two lines of an OMM, given by its keywords.

    Raises:
        ValueError: a keyword is missing, or its value is not one that SGP4 or two lines can take.
    """
    for key, allowed in (
        ("MEAN_ELEMENT_THEORY", ("SGP4", "SGP/SGP4")),
        ("REF_FRAME", ("TEME",)),
        ("TIME_SYSTEM", ("UTC",)),
    ):
        given = str(fields.get(key) or allowed[0]).strip()
        if given not in allowed:
            raise ValueError(f"{key} is {given!r:.40}: it has to be {allowed[0]}")
    catalogue = int(_number(fields, "NORAD_CAT_ID", 0.0, 999_999_999.0, 0.0))
    satellite = _alpha_5(catalogue) if catalogue <= _MOST_ALPHA_5 else "00000"
    first = (
        f"1 {satellite}U {_designator(fields):8} {_epoch(fields)}  .00000000  00000-0 {_bstar(fields)} 0  999"
    )
    angles = (
        f"{_number(fields, 'INCLINATION', 0.0, 180.0):8.4f}",
        _angle(fields, "RA_OF_ASC_NODE"),
        f"{_number(fields, 'ECCENTRICITY', 0.0, 0.9999999):.7f}"[2:],
        _angle(fields, "ARG_OF_PERICENTER"),
        _angle(fields, "MEAN_ANOMALY"),
    )
    revolution = int(_number(fields, "REV_AT_EPOCH", 0.0, 1e9, 0.0)) % 100_000
    motion = f"{_number(fields, 'MEAN_MOTION', 0.0, 99.0):11.8f}"
    second = f"2 {satellite} {' '.join(angles)} {motion}{revolution:5d}"
    return f"{first}{compute_checksum(first)}", f"{second}{compute_checksum(second)}"


def _number(
    fields: Mapping[str, Any], key: str, least: float, most: float, otherwise: float | None = None
) -> float:
    given = fields.get(key)
    if given is None or given == "":
        if otherwise is None:
            raise ValueError(f"{key} is missing")
        return otherwise
    try:
        value = float(given)
    except (TypeError, ValueError):
        raise ValueError(f"{key} is {given!r:.40}, which is no number") from None
    if not (isfinite(value) and least <= value <= most):
        raise ValueError(f"{key} is {value:g}: from {least:g} to {most:g} is allowed")
    return value


def _angle(fields: Mapping[str, Any], key: str) -> str:
    text = f"{_number(fields, key, -360.0, 360.0) % 360.0:8.4f}"
    return "  0.0000" if text == "360.0000" else text


def _alpha_5(number: int) -> str:
    high, low = divmod(number, 10_000)
    return f"{number:05d}" if high < 10 else f"{_LETTERS[high - 10]}{low:04d}"


def _designator(fields: Mapping[str, Any]) -> str:
    """Launch year, launch and piece; blanks where there is none."""
    found = re.fullmatch(r"\d{2}(\d{2})-(\d{3}[A-Z]{1,3})", str(fields.get("OBJECT_ID") or "").strip())
    return f"{found[1]}{found[2]}" if found else ""


def _epoch(fields: Mapping[str, Any]) -> str:
    """Year and day of the year; no further than the end of its year."""
    text = str(fields.get("EPOCH") or "").strip()
    if not text:
        raise ValueError("EPOCH is missing")
    try:
        by_day = re.fullmatch(r"(\d{4})-(\d{3})(T.*)", text)
        moment = datetime.fromisoformat(f"{by_day[1]}-01-01{by_day[3]}" if by_day else text)
        moment += (int(by_day[2]) - 1) * _DAY if by_day else 0 * _DAY
    except (ValueError, OverflowError):
        raise ValueError(f"EPOCH is {text!r:.40}: a time like 2025-12-11T13:21:59.411232 is needed") from None
    moment = moment.astimezone(UTC) if moment.tzinfo else moment.replace(tzinfo=UTC)
    if not 1957 <= moment.year <= 2056:
        raise ValueError(f"EPOCH is in {moment.year}: elements are of 1957 to 2056")
    begun = datetime(moment.year, 1, 1, tzinfo=UTC)
    days = (datetime(moment.year + 1, 1, 1, tzinfo=UTC) - begun) // _DAY
    units = min(round((moment - begun) // _MICROSECOND / 864.0), days * 10**8 - 1)
    return f"{moment.year % 100:02d}{units // 10**8 + 1:03d}.{units % 10**8:08d}"


def _bstar(fields: Mapping[str, Any]) -> str:
    value = _number(fields, "BSTAR", -1.0, 1.0, 0.0)
    mantissa, _, power = f"{abs(value):.4e}".partition("e")
    exponent = int(power) + 1
    if value == 0.0 or exponent < -9:
        return " 00000-0"
    return f"{'-' if value < 0.0 else ' '}{mantissa.replace('.', '')}{exponent:+d}".replace("+0", "-0")


def _two_lines(lines: list[str]) -> Iterator[FiledElements]:
    name, number = "", 0
    while number < len(lines):
        line = plain_line(lines[number])
        if line.startswith("1 ") and len(line) == 69:
            second = plain_line(lines[number + 1]) if number + 1 < len(lines) else ""
            if not second.startswith("2 "):
                raise ValueError(f"after line {number + 1} its second element line is missing")
            try:
                read_tle(line, second)
            except ValueError as error:
                raise ValueError(f"line {number + 1}: {error}") from None
            yield FiledElements(name, (line, second), f"line {number + 1}")
            number, name = number + 1, ""
        elif line.startswith(("1 ", "2 ")) and len(line.split()) > 6:
            raise ValueError(f"line {number + 1} is no element line of 69 characters in its place")
        elif line and not line.startswith("#"):
            name = _name(lines[number].strip().removeprefix("0 "))
        number += 1


def _name(text: str) -> str:
    """A satellite's name as it is shown."""
    return "".join(letter for letter in text if letter.isprintable())[:LONGEST_NAME].strip()


# --- Of a file of element sets the one nearest in time

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
