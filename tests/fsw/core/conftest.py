import csv
from datetime import UTC, datetime
from pathlib import Path

import pytest
from flight_states import altered
from gate_samples import measured

from fsw.core.commands import command
from fsw.core.modes import ModeState
from fsw.core.orbit.ephemeris import advance
from fsw.core.orbit.propagation import sgp4_orbit
from fsw.core.packing import copy_state, pack
from fsw.core.step import boot
from fsw.wire.messages import Element, Mode, TcAckResult, TcOrbitElement
from sim.validate.reference.reference_table import DATA

ROOT = Path(__file__).resolve().parents[3]
TICK = 40
"""Of the telecommands."""


def unix_of(utc_iso):
    moment = datetime.fromisoformat(utc_iso)
    assert moment.tzinfo == UTC
    return moment.timestamp()


def with_checksum(line):
    body = line[:68]
    return body + str(sum(int(c) if c.isdigit() else c == "-" for c in body) % 10)


@pytest.fixture(scope="session")
def reference_rows():
    """Rows of a reference table as dictionaries of text, with ``unix_s`` added."""

    def rows(name):
        lines = (DATA / name).read_text(encoding="utf-8").splitlines()
        table = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        return [row | {"unix_s": unix_of(row["utc_iso"])} for row in table]

    return rows


@pytest.fixture(scope="session")
def vector_of():
    """A vector from the columns ``prefix`` + x, y, z + ``suffix`` of a row."""

    def vector(row, prefix, suffix=""):
        return tuple(float(row[f"{prefix}{axis}{suffix}"]) for axis in "xyz")

    return vector


@pytest.fixture(scope="session")
def gauss_by_year():
    """IGRF-14 of the plant's own table: {year: {(n, m): nT}}."""
    text = (ROOT / "sim" / "plant" / "environment" / "igrf14.shc").read_text(encoding="utf-8")
    lines = [line.split() for line in text.splitlines() if not line.startswith("#")]
    return {
        int(float(year)): {(int(n), int(m)): float(values[column]) for n, m, *values in lines[2:]}
        for column, year in enumerate(lines[1])
    }


@pytest.fixture(scope="session")
def gauss_at(gauss_by_year):
    """Coefficients at a time, linear in elapsed time between the models."""

    def at(unix_s):
        year = max(year for year in (2015, 2020, 2025) if unix_of(f"{year}-01-01T00:00:00Z") <= unix_s)
        start_s, end_s = unix_of(f"{year}-01-01T00:00:00Z"), unix_of(f"{year + 5}-01-01T00:00:00Z")
        part = (unix_s - start_s) / (end_s - start_s)
        before, after = gauss_by_year[year], gauss_by_year[year + 5]
        return {key: (1.0 - part) * before[key] + part * after[key] for key in before}

    return at


@pytest.fixture(scope="session")
def tle():
    """Element lines by satellite name."""
    lines = [
        line
        for line in (DATA / "tle.txt").read_text(encoding="utf-8").splitlines()
        if line and not line.startswith("#")
    ]
    return {lines[i]: (lines[i + 1], lines[i + 2]) for i in range(0, len(lines), 3)}


@pytest.fixture(scope="session")
def itamsat(tle):
    return sgp4_orbit(*tle["ITAMSAT"])


ITAMSAT_EPOCH_UNIX_S = 1427424417
"""The first whole second after the epoch of the elements: 2015, day 86.11593543."""


@pytest.fixture(scope="session")
def itamsat_epoch_unix_s():
    return ITAMSAT_EPOCH_UNIX_S


@pytest.fixture(scope="session")
def decaying(tle):
    """ITAMSAT with a drag term that brings it down within days."""
    line1, line2 = tle["ITAMSAT"]
    draggy = line1[:53] + " 99999+0" + line1[61:]
    return with_checksum(draggy), line2


@pytest.fixture(scope="session")
def checksummed():
    return with_checksum


DIGITS = {
    Element.EPOCH_DAY: (16521, 0),
    Element.EPOCH_FRACTION: (11593543, -8),
    Element.INCLINATION_DEG: (986946, -4),
    Element.RAAN_DEG: (364208, -4),
    Element.ECCENTRICITY: (8932, -7),
    Element.PERIGEE_DEG: (1738349, -4),
    Element.ANOMALY_DEG: (1862944, -4),
    Element.MOTION_REVPDAY: (1430166407, -8),
    Element.BSTAR: (11414, -8),
}
"""ITAMSAT: the numbers of its two-line elements, whose epoch is 2015, day 86.11593543."""


def elements_of(**changed):
    """TC_ORBIT_ELEMENT for each, in order, with some digits changed or left out (None)."""
    digits = {e: changed.get(e.name.lower(), d) for e, d in DIGITS.items()}
    kept = [(e, d) for e, d in digits.items() if d is not None]
    return [TcOrbitElement(e, d[1], d[0], counter=n & 0xF) for n, (e, d) in enumerate(kept)]


@pytest.fixture(scope="session")
def digits():
    """Mantissa and exponent of each orbit element of ITAMSAT."""
    return DIGITS


@pytest.fixture(scope="session")
def elements():
    """Makes the telecommands that upload these elements."""
    return elements_of


@pytest.fixture(scope="module")
def config(make_world):
    return make_world().config


@pytest.fixture(scope="module")
def state(config):
    """All is well: the attitude is known, the law has a memory, the orbit a window."""
    booted = boot(config)
    return altered(
        booted,
        tick=TICK,
        attitude=booted.attitude.replace(valid=True, usable=True),
        modes=ModeState(Mode.ACQUIRE, 11, trips=1),
        memory=(0.25, -0.5),
        ephemeris=advance(None, TICK, config.ephemeris),
    )


@pytest.fixture(scope="module")
def obey(config):
    """Carries out telecommands: the state, and the results."""

    def through(state, *telecommands, violated=None, config=config):
        after = copy_state(state)
        acks = command(after, measured(telecommands=telecommands), violated, config)
        assert [(ack.command, ack.command_counter, ack.tick) for ack in acks] == [
            (message.ID, message.counter, TICK) for message in telecommands
        ]
        return after, [TcAckResult(ack.result) for ack in acks]

    return through


@pytest.fixture
def refused(obey, state, leaves):
    """Whether the last of the telecommands is refused for this reason, and changes nothing."""

    def check(reason, *telecommands, start=state, **circumstances):
        before, _ = obey(start, *telecommands[:-1], **circumstances)
        after, results = obey(before, telecommands[-1], **circumstances)
        assert results == [reason]
        assert pack(after) == pack(before)

    return check
