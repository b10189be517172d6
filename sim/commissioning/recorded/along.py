"""Where the satellite was in each tick of a pass, by its elements, with the field and the Sun there."""

from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, ephemeris_model, reference_at
from fsw.table.flown_elements import check_flown
from sim.commissioning.recorded.recorded_pass import RecordedPass
from sim.commissioning.recorded.strays import stray_currents, stray_strengths, stray_values
from sim.console import warn
from sim.errors import HarnessError
from sim.scenario.element_file import ElementSet, nearest_elements
from sim.value_types import Array

Integers = NDArray[np.int64]
Mask = NDArray[np.bool_]

NT_PER_T = 1e9
FASTEST_HZ = 100
MOST_TICKS, BESIDE_TICK = 10, 0.01
"""How much finer than the samples ticks may be, and how far beside a tick the usual sample may be, ticks."""
YEAR_DAYS = 366.0
MOST_OFF = 30.0
"""Factor between the fields measured and expected that no offset explains: units differ by 100 and more."""
GPS_EPOCH_UNIX_S, J2000_UNIX_S = 315_964_800.0, 946_728_000.0
OLD_DAYS = 7.0
"""Elements further away put the satellite tens of kilometres off: 10 nT and more each."""
STRAY_CELL, STRAY_GYRO, STRAY_TEMPERATURE, STRAY_FIELD = (
    "with a Sun cell far beyond its brightest",
    "with a gyro far from its others",
    "with a temperature far from the others",
    "whose field has not the strength of the orbit's",
)
NEARLY_ALL, MOST_TICKS_APART = 0.9, 600
"""Part of the samples that lie a number of ticks apart, or multiples of it, and the largest such number."""


@dataclass(frozen=True, slots=True)
class Along:
    """The pass beside what the elements give, row by row.

    Attributes:
        recorded: the pass.
        elements: those that were used.
        tick_s: length of a tick.
        tick: of each row, (n), counted from the first row.
        first_of_tick: whether no earlier row has the tick: later ones are of an unknown moment, (n).
        references: by tick, for every tick that a row has.
        b_eci_nt: field, (n, 3); ``sun_eci``: unit vector, (n, 3); ``lit``: (n).
    """

    recorded: RecordedPass
    elements: ElementSet
    tick_s: float
    tick: Integers
    first_of_tick: NDArray[np.bool_]
    references: dict[int, Reference]
    b_eci_nt: Array
    sun_eci: Array
    lit: NDArray[np.bool_]

    @property
    def t_s(self) -> Array:
        """Time of each row since the first one, (n)."""
        t_s: Array = np.asarray((self.tick - self.tick[0]) * self.tick_s, dtype=np.float64)
        return t_s

    @property
    def strength_nt(self) -> Array:
        """Strength of the field, (n)."""
        strength: Array = np.sqrt(np.sum(self.b_eci_nt**2, axis=1))
        return strength


def placed(recorded: RecordedPass, tle: Path) -> Along:
    """The pass along the nearest elements of a file, without the rows that the others do not bear out.

    The user is warned of elements that are far away, and of samples that are further apart than a second.

    Raises:
        HarnessError: as ``nearest_elements`` and ``along``.
    """
    elements = nearest_elements(tle, recorded.middle_unix_s)
    _check_clock(recorded, elements, tle)
    around = along(recorded, elements)
    _check_unit(around)
    around = screened(around)
    age_days = around.elements.age_days(recorded.middle_unix_s)
    if abs(age_days) > OLD_DAYS:
        warn(f"{tle}: the nearest element set is {abs(age_days):.0f} days away: its field may be off")
    if ticks_apart(around) > 1:
        apart_s = 1.0 / sample_hz(around)
        warn(
            f"{recorded.name}: samples are {apart_s:g} s apart: a spin beyond {180.0 / apart_s:.3g} deg/s "
            "looks like a slower one"
        )
    return around


def _check_clock(recorded: RecordedPass, elements: ElementSet, tle: Path) -> None:
    """Check that the times are not those of another clock, by which the elements would be of the same year.

    Raises:
        HarnessError: they are.
    """
    middle_s = recorded.middle_unix_s
    if abs(elements.age_days(middle_s)) <= YEAR_DAYS:
        return
    for clock, unix_s in (
        ("milliseconds", 1e-3 * middle_s),
        ("GPS seconds, since 1980", middle_s + GPS_EPOCH_UNIX_S),
        ("seconds since 2000", middle_s + J2000_UNIX_S),
    ):
        there = nearest_elements(tle, unix_s)
        if abs(there.age_days(unix_s)) <= YEAR_DAYS:
            raise HarnessError(
                f"{recorded.name}: column 'utc_unix_s' is about {middle_s:.15g}, and the elements are of "
                f"Unix time {there.epoch_unix_s} s: is it in {clock}?"
            )


def _check_unit(around: Along) -> None:
    """Check that the field is of the order of the Earth's: an offset may be as large, and not much larger.

    Raises:
        HarnessError: it is not.
    """
    strength_nt = np.linalg.norm(around.recorded.mag_nt, axis=1)
    measured_nt = float(np.median(strength_nt[strength_nt > 0.0]))  # neither of empty rows nor of zeros
    expected_nt = float(np.median(around.strength_nt))
    if not expected_nt / MOST_OFF < measured_nt < expected_nt * MOST_OFF:
        raise HarnessError(
            f"{around.recorded.name}: by the unit in its columns the field is about {measured_nt:.3g} nT, "
            f"and the Earth's is {expected_nt:.3g} nT there: is it in another unit?"
        )


def along(recorded: RecordedPass, elements: ElementSet) -> Along:
    """The field and the Sun along the elements as the flight software has them (SGP4, IGRF-14, almanac Sun).

    Raises:
        HarnessError: SGP4 finds no orbit, or the field does not hold at that time.
    """
    since_s = recorded.utc_unix_s - recorded.utc_unix_s[0]
    start_unix_s = round(recorded.utc_unix_s[0])  # of the orbit, which half a second moves by 4 km
    hertz = _tick_hz(since_s)
    try:
        check_flown(elements.orbit, float(recorded.utc_unix_s[0]), float(recorded.utc_unix_s[-1]))
        model = ephemeris_model(elements.orbit, start_unix_s, hertz)
    except ValueError as error:
        raise HarnessError(f"{recorded.name}: {error}") from None
    tick = np.rint(since_s * hertz).astype(np.int64)
    references = _references(recorded.name, tick, model)
    rows = [references[number] for number in tick.tolist()]
    return Along(
        recorded=recorded,
        elements=elements,
        tick_s=1.0 / hertz,
        tick=tick,
        first_of_tick=np.diff(tick, prepend=tick[0] - 1) > 0,
        references=references,
        b_eci_nt=NT_PER_T * np.array([row.b_eci_t for row in rows]),
        sun_eci=np.array([row.sun_eci for row in rows]),
        lit=np.array([row.lit for row in rows]),
    )


def without(around: Along, rows: Mask, why: str) -> Along:
    """The pass without these rows, (n), as if they had never been there."""
    if not rows.any():
        return around
    return along(around.recorded.without(rows, why), around.elements)


def screened(around: Along) -> Along:
    """The pass without rows of which a value cannot be, or whose field is not that of the others."""
    for why, find in (
        (STRAY_CELL, _stray_cells),
        (STRAY_GYRO, _stray_gyro),
        (STRAY_TEMPERATURE, _stray_temperature),
        (STRAY_FIELD, _stray_field),
    ):
        strays = find(around)
        if around.recorded.may_lack(int(strays.sum()), why):
            around = without(around, strays, why)
    return around


def _stray_cells(around: Along) -> Mask:
    strays = np.zeros(len(around.lit), dtype=np.bool_)
    for currents in around.recorded.cells.values():
        strays |= stray_currents(currents, around.lit)
    return strays


def _stray_gyro(around: Along) -> Mask:
    gyro_degps = around.recorded.gyro_degps
    strays = np.zeros(len(around.lit), dtype=np.bool_)
    for rates in () if gyro_degps is None else gyro_degps.T:
        strays |= stray_values(rates)
    return strays


def _stray_temperature(around: Along) -> Mask:
    degc = around.recorded.temperature_degc
    return np.zeros(len(around.lit), dtype=np.bool_) if degc is None else stray_values(degc)


def _stray_field(around: Along) -> Mask:
    return stray_strengths(around.recorded.mag_nt, around.strength_nt)


def _tick_hz(since_s: Array) -> int:
    """The rate of the samples, 1 Hz if they are slower; more where it takes finer ticks to fall on them."""
    steps = np.diff(since_s)
    steps = steps[steps > 0.0]
    usual_s = float(np.median(steps)) if len(steps) else inf
    slowest = min(max(round(1.0 / usual_s), 1), FASTEST_HZ)
    if usual_s == inf:
        return slowest
    rates = range(slowest, min(MOST_TICKS * slowest, FASTEST_HZ) + 1)
    return next((hz for hz in rates if abs(usual_s * hz - round(usual_s * hz)) < BESIDE_TICK), slowest)


def _references(name: str, ticks: Integers, model: EphemerisModel) -> dict[int, Reference]:
    window, references = None, {}
    for tick in ticks.tolist():
        window = advance(window, tick, model)
        if window is None:
            raise HarnessError(f"{name}: SGP4 finds no orbit {tick / model.tick_hz:.0f} s into the pass")
        references[tick] = reference_at(window, tick, model)
    return references


def sample_hz(around: Along) -> float:
    """The rate of the samples, beyond half of which a spin looks like a slower one."""
    return 1.0 / (around.tick_s * ticks_apart(around))


def ticks_apart(around: Along) -> int:
    """How many ticks, or a multiple of them, nearly all samples are from each other."""
    ticks = around.tick[sampled(around)]
    usual = int(np.median(np.diff(ticks))) if len(ticks) > 1 else 1
    found = 1
    for number in range(2, min(usual, MOST_TICKS_APART) + 1):
        if np.bincount(ticks % number).max() >= NEARLY_ALL * len(ticks):
            found = number
    return found


def sampled(around: Along) -> Integers:
    """The rows with a field sample whose moment is known, in order."""
    finite = np.isfinite(around.recorded.mag_nt).all(axis=1)
    rows: Integers = np.flatnonzero(finite & around.first_of_tick)
    return rows
