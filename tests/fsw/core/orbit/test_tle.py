"""Two-line elements: their format is checked once, and sgp4 reads the digits that stand in the columns."""

from datetime import UTC, date, datetime
from decimal import Decimal
from math import ceil
from random import Random

import pytest

from fsw.core.orbit.elements import Elements
from fsw.core.orbit.tle import plain_line, read_tle, tle_elements, tle_epoch_unix_s

ROUNDS = 2000


def replaced(line, first_column, text):
    return line[: first_column - 1] + text + line[first_column - 1 + len(text) :]


@pytest.mark.parametrize("index", [0, 1])
@pytest.mark.parametrize(
    "spoil",
    [
        lambda line: "",
        lambda line: line[:-1],
        lambda line: line + "0",
        lambda line: replaced(line, 1, "3"),
        lambda line: replaced(line, 21, "x"),
        lambda line: replaced(line, 30, "\0"),
        lambda line: replaced(line, 30, "²"),
        lambda line: replaced(line, 69, "x"),
    ],
)
def test_a_malformed_line_is_refused_by_its_number(tle, spoil, index):
    lines = list(tle["ITAMSAT"])
    lines[index] = spoil(lines[index])
    with pytest.raises(ValueError, match=f"element line {index + 1} is not in the two-line format"):
        read_tle(*lines)


@pytest.mark.parametrize("index", [0, 1])
def test_every_digit_is_under_the_checksum(tle, index):
    lines = tle["ITAMSAT"]
    for column in range(8, 69):
        old = lines[index][column - 1]
        if old.isdigit():
            spoilt = list(lines)
            spoilt[index] = replaced(lines[index], column, str((int(old) + 1) % 10))
            with pytest.raises(ValueError, match=f"element line {index + 1} has checksum"):
                read_tle(*spoilt)


def test_lines_in_the_wrong_order_are_refused(tle):
    line1, line2 = tle["ITAMSAT"]
    with pytest.raises(ValueError, match="element line 1"):
        read_tle(line2, line1)


def test_lines_of_two_satellites_are_refused(tle):
    with pytest.raises(ValueError, match="two satellites, 22826 and 14781"):
        read_tle(tle["ITAMSAT"][0], tle["UO-11"][1])


@pytest.mark.parametrize(
    ("day", "days"), [("17366.0", 365), ("17500.5", 365), ("20367.0", 366), ("00999.9", 366)]
)
def test_a_day_that_its_year_does_not_have_is_refused(tle, checksummed, day, days):
    line1, line2 = tle["ITAMSAT"]
    sentence = f"element line 1 has day {day[2:5]} of the year, and year {day[:2]} has {days}"
    with pytest.raises(ValueError, match=sentence):
        read_tle(checksummed(replaced(line1, 19, day)), line2)


def test_the_last_day_of_a_leap_year_is_one(epoch_of):
    assert epoch_of("20366.00000000") == int(datetime(2020, 12, 31, tzinfo=UTC).timestamp())


def test_day_0_is_the_last_day_of_the_year_before(epoch_of):
    assert epoch_of("21000.00000000") == int(datetime(2020, 12, 31, tzinfo=UTC).timestamp())


@pytest.mark.parametrize("blank", ["\u00a0", "\u2007", "\t"])
def test_a_plain_line_has_common_blanks_and_capitals(tle, blank):
    for line in tle["ITAMSAT"]:
        assert plain_line(line.replace(" ", blank).lower() + " \r\n") == line


@pytest.fixture
def epoch_of(tle, checksummed):
    """The epoch of ITAMSAT's elements with another year and day in columns 19 to 32."""
    line1, line2 = tle["ITAMSAT"]
    return lambda day: tle_epoch_unix_s(checksummed(replaced(line1, 19, day)), line2)


@pytest.mark.parametrize(
    ("day", "moment"),
    [
        ("15086.11593543", (2015, 3, 27, 2, 46, 57)),  # 02:46:56.82
        ("15086.00000000", (2015, 3, 27, 0, 0, 0)),  # a whole second is not rounded
        ("15086.00000001", (2015, 3, 27, 0, 0, 1)),  # 0.9 ms
        ("15086.50000000", (2015, 3, 27, 12, 0, 0)),
        ("24001.00000000", (2024, 1, 1, 0, 0, 0)),
        ("24366.99999999", (2025, 1, 1, 0, 0, 0)),  # into the next year
        ("57001.00000000", (1957, 1, 1, 0, 0, 0)),
        ("56001.00000000", (2056, 1, 1, 0, 0, 0)),
        ("99365.25000000", (1999, 12, 31, 6, 0, 0)),
    ],
)
def test_the_epoch_is_rounded_up_to_a_whole_second(epoch_of, day, moment):
    assert epoch_of(day) == int(datetime(*moment, tzinfo=UTC).timestamp())


@pytest.mark.long
def test_the_epoch_is_that_of_the_columns_to_the_second(epoch_of):
    """Against decimal arithmetic on the text, at any time of any day of a hundred years."""
    random = Random(1)
    for _ in range(ROUNDS):
        year, day = random.randrange(100), random.randrange(1, 366)
        part = random.choice((random.randrange(10**8), random.randrange(0, 10**8, 31_250), 10**8 - 1))
        text = f"{day:03d}.{part:08d}"
        january = datetime(year + (1900 if year >= 57 else 2000), 1, 1, tzinfo=UTC)
        expected = int(january.timestamp()) + ceil((Decimal(text) - 1) * 86400)
        assert epoch_of(f"{year:02d}{text}") == expected, text


@pytest.mark.long
def test_every_element_is_the_number_of_its_column(tle, checksummed):
    random = Random(2)
    line1, line2 = tle["ITAMSAT"]
    for _ in range(ROUNDS):
        angles = [f"{random.randrange(180 * 10**4) / 1e4:8.4f}" for _ in range(4)]
        eccentricity = f"{random.randrange(10**7):07d}"
        motion = f"{random.randrange(6 * 10**8, 17 * 10**8) / 1e8:11.8f}"
        mantissa, sign, power = random.randrange(10**5), random.choice(" -"), random.randrange(9)
        drag = checksummed(replaced(line1, 54, f"{sign}{mantissa:05d}-{power}"))
        inclination, raan, perigee, anomaly = angles
        shape = checksummed(
            replaced(line2, 9, f"{inclination} {raan} {eccentricity} {perigee} {anomaly} {motion}")
        )
        elements = tle_elements(drag, shape)
        assert elements == Elements(
            (date(2015, 1, 1) - date(1970, 1, 1)).days + 85,
            0.11593543,
            float(inclination),
            float(raan),
            float(f"0.{eccentricity}"),
            float(perigee),
            float(anomaly),
            float(motion),
            float(f"{sign.strip()}0.{mantissa:05d}e-{power}"),
        )
