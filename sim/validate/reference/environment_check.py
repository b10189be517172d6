"""Field, Earth, Sun, shadow and orbit in both implementations: igrf14, earth_sun and eclipse.csv, tle.txt."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fsw.core.orbit import earth as onboard_earth
from fsw.core.orbit import igrf as onboard
from fsw.core.orbit import sun as onboard_sun
from fsw.core.orbit.igrf_coefficients import EPOCHS_UNIX_S, MAX_DEGREE
from fsw.core.orbit.propagation import sgp4_orbit, state_eci
from fsw.core.orbit.sun import lit
from fsw.core.orbit.tle import read_tle, tle_elements, tle_epoch_unix_s
from sim.campaign.claim import Claim, ClaimOutcome, Threshold
from sim.errors import HarnessError
from sim.plant.environment import earth as plant_earth
from sim.plant.environment.igrf import Igrf
from sim.plant.environment.orbit import DAY_S, UNIX_EPOCH_JD, Sgp4Orbit
from sim.plant.environment.sun import illumination, sun_eci_m
from sim.validate.reference.comparison import ReferenceComparison, angle_rad, largest, mismatch
from sim.validate.reference.reference_table import ReferenceTable, names_of, read_lines
from sim.value_types import Array

# --- igrf14.csv: both implementations of the geomagnetic field, Earth-fixed position to Earth-fixed field

SAME_EPOCHS_NT = 1e-3
"""Rounding of other software near the poles; the formulas agree to 1e-10 nT."""
SAME_FORMULA_NT = 5e-10
"""Rounding of the two implementations of one series."""
OTHER_EPOCHS_NT = 0.5
"""Coefficients linear in decimal years instead of elapsed days differ by up to 0.22 nT."""


def check_field(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare the plant's field at every row, the onboard one at those in the years of its model.

    Raises:
        HarnessError: a row is malformed or outside the years of the model.
    """
    unix_s = table.unix_s("utc_iso")
    r_m = 1e3 * table.columns(*names_of("r_ecef_", "xyz", "_km"))
    reference_nt = table.columns(*names_of("b_ecef_", "xyz", "_nT"))
    other_nt = table.columns(*names_of("b_decyear_", "xyz", "_nT"))
    _check_places(table, r_m)
    plant_nt = 1e9 * _field_at_rows(table, Igrf(), unix_s, r_m)
    yield ReferenceComparison(
        "plant",
        "Plant's field, IGRF-14 to degree 13",
        "nT",
        largest(plant_nt - reference_nt),
        SAME_EPOCHS_NT,
    )
    yield ReferenceComparison(
        "decimal_years",
        "The same against coefficients linear in decimal years",
        "nT",
        largest(plant_nt - other_nt),
        OTHER_EPOCHS_NT,
    )
    rows = np.flatnonzero((unix_s >= EPOCHS_UNIX_S[0]) & (unix_s <= EPOCHS_UNIX_S[-1]))
    flight_nt = _onboard_nt(unix_s[rows], r_m[rows])
    short_nt = 1e9 * Igrf(MAX_DEGREE).at(unix_s[rows], r_m[rows]) if len(rows) else flight_nt
    yield ReferenceComparison(
        "onboard",
        f"Onboard field against the plant's, both to degree {MAX_DEGREE}",
        "nT",
        largest(flight_nt - short_nt),
        SAME_FORMULA_NT,
        Threshold.OWN,
        rows=rows,
    )
    beyond_nt = plant_nt[rows] - short_nt
    yield ReferenceComparison(
        "onboard_reference",
        f"Onboard field with the plant's degrees above {MAX_DEGREE} added",
        "nT",
        largest(flight_nt + beyond_nt - reference_nt[rows]),
        SAME_EPOCHS_NT,
        rows=rows,
    )


def _onboard_nt(unix_s: Array, r_m: Array) -> Array:
    """The field as it is computed on board, (n, 3)."""
    field_nt = np.zeros_like(r_m)
    for row, (at_s, (x, y, z)) in enumerate(zip(unix_s.tolist(), r_m.tolist(), strict=True)):
        model = onboard.prepare(at_s // 86400.0 * 86400.0)
        field_nt[row] = 1e9 * np.array(onboard.field_ecef_t((x, y, z), at_s, model))
    return field_nt


def _field_at_rows(table: ReferenceTable, model: Igrf, unix_s: Array, r_m: Array) -> Array:
    """The field at all rows; an error gives the first row that the model rejects."""
    try:
        return model.at(unix_s, r_m)
    except ValueError:
        for row, line in enumerate(table.lines):
            try:
                model.at(unix_s[row : row + 1], r_m[row : row + 1])
            except ValueError as error:
                raise HarnessError(f"{table.path}, line {line}, column utc_iso: {error}") from None
        raise


def _check_places(table: ReferenceTable, r_m: Array) -> None:
    for line, r in zip(table.lines, r_m, strict=True):
        if not np.any(r):
            raise HarnessError(f"{table.path}, line {line}, column r_ecef_x_km: the centre of the Earth")


# --- earth_sun.csv: the Earth's rotation and the Sun, in both implementations

ROTATION_RAD = 1e-9
"""Both are the same closed formula; a double holds the time to 2e-11 rad."""
SUN_RAD = 3e-4
"""The almanac's formula is good to 0.01 deg; mean and true equinox of date are as far apart again."""
SUN_DISTANCE = 1e-4
"""Relative, of the same formula."""
INDICES = [f"{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)]


def check_earth_and_sun(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare rotation, Sun and distance at every row.

    Raises:
        HarnessError: a row is malformed.
    """
    day, fraction = table.columns("jd_utc1", "jd_utc2").T
    unix_s = (day - UNIX_EPOCH_JD) * DAY_S + fraction * DAY_S
    yield from _rotation(table, unix_s)
    yield from _sun_directions(table, unix_s)


def _rotation(table: ReferenceTable, unix_s: Array) -> Iterator[ReferenceComparison]:
    angle = table.column("gmst82_rad")
    pef_from_teme = table.columns(*names_of("t2p_", INDICES)).reshape(-1, 3, 3)
    itrs_from_gcrs = table.columns(*names_of("c2t_", INDICES)).reshape(-1, 3, 3)
    sun_gcrs, sun_teme = (table.columns(*names_of(f"sun_{frame}_", "xyz")) for frame in ("geo", "teme"))
    sun_itrs = np.einsum("nij,nj->ni", itrs_from_gcrs, sun_gcrs)
    for who, angles, turns in (("Plant", *_plant_rotation(unix_s)), ("Onboard", *_onboard_rotation(unix_s))):
        name, apart = who.lower(), np.angle(np.exp(1j * (angles - angle)))
        yield ReferenceComparison(
            f"gmst_{name}", f"{who} sidereal time (GMST82)", "rad", np.abs(apart), ROTATION_RAD
        )
        yield ReferenceComparison(
            f"turn_{name}",
            f"{who} turn TEME to Earth-fixed",
            "1",
            largest(turns - pef_from_teme),
            ROTATION_RAD,
        )
        yield ReferenceComparison(
            f"chain_{name}",
            f"{who} turn of the Sun's direction against IAU 2006/2000A, GCRS to Earth-fixed",
            "1",
            largest(np.einsum("nij,nj->ni", turns, sun_teme) - sun_itrs),
            ROTATION_RAD,
        )


def _sun_directions(table: ReferenceTable, unix_s: Array) -> Iterator[ReferenceComparison]:
    plant_m = np.concatenate([sun_eci_m(int(t), np.array([t % 1.0])) for t in unix_s])
    distance_m = np.linalg.norm(plant_m, axis=1)
    onboard = np.array([onboard_sun.sun_eci(t) for t in unix_s.tolist()])
    itrs_from_gcrs = table.columns(*names_of("c2t_", INDICES)).reshape(-1, 3, 3)
    pef_from_teme = table.columns(*names_of("t2p_", INDICES)).reshape(-1, 3, 3)
    gcrs_from_teme = itrs_from_gcrs.transpose(0, 2, 1) @ pef_from_teme
    unturned = np.broadcast_to(np.eye(3), gcrs_from_teme.shape)
    frames = (
        ("mod", "mean equinox of date", unturned),
        ("teme", "TEME", unturned),
        ("app", "apparent, turned to GCRS by the reference's matrices", gcrs_from_teme),
    )
    for who, ours in (("Plant", plant_m / distance_m[:, None]), ("Onboard", onboard)):
        for frame, meaning, turn in frames:
            theirs = table.columns(*names_of(f"sun_{frame}_", "xyz"))
            yield ReferenceComparison(
                f"sun_{frame}_{who.lower()}",
                f"{who} direction of the Sun, {meaning}",
                "rad",
                np.maximum(
                    angle_rad(np.einsum("nij,nj->ni", turn, ours), theirs),
                    np.abs(np.linalg.norm(theirs, axis=1) - 1.0),
                ),
                SUN_RAD,
            )
    theirs_m = 1e3 * table.column("sun_dist_km")
    yield ReferenceComparison(
        "sun_distance",
        "Plant's distance of the Sun, relative",
        "1",
        np.abs(distance_m / theirs_m - 1.0),
        SUN_DISTANCE,
    )


def _plant_rotation(unix_s: Array) -> tuple[Array, Array]:
    """Angles (n,) and matrices (n, 3, 3): a whole-second epoch some time before each row, and the rest."""
    angles = np.concatenate(
        [plant_earth.gmst82_rad(int(t) - 5000, np.array([5000.0 + t % 1.0])) for t in unix_s]
    )
    columns = [plant_earth.turn_about_pole(angles, np.tile(axis, (len(angles), 1))) for axis in np.eye(3)]
    return angles, np.stack(columns, axis=2)


def _onboard_rotation(unix_s: Array) -> tuple[Array, Array]:
    angles = [onboard_earth.gmst82_rad(t) for t in unix_s.tolist()]
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    columns = [[onboard_earth.rotate_about_pole(angle, axis) for axis in axes] for angle in angles]
    return np.array(angles), np.array(columns).transpose(0, 2, 1)


# --- eclipse.csv: the visible fraction of the Sun

SAME_MODEL = 1e-7
"""The planar two-circle formula; arccos near full shadow costs half the digits."""
OTHER_MODEL = 5e-3
"""The Earth's limb is not a plane circle: the exact fraction differs by up to 2e-4 in low orbits."""


def check_eclipse(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare fraction, class and cylinder at every row.

    Raises:
        HarnessError: a row is malformed.
    """
    r_m = 1e3 * table.columns(*names_of("sat_", "xyz", "_km"))
    sun_m = 1e3 * table.columns(*names_of("sun_", "xyz", "_km"))
    fraction = illumination(r_m, sun_m)
    planar, exact = table.column("frac_planar"), table.column("frac_exact")
    classes = table.texts("class")
    yield ReferenceComparison(
        "planar", "Plant's lit fraction, plane circles", "1", np.abs(fraction - planar), SAME_MODEL
    )
    yield ReferenceComparison(
        "exact", "Plant's lit fraction against the exact one", "1", np.abs(fraction - exact), OTHER_MODEL
    )
    yield ReferenceComparison(
        "class",
        "Rows where the plant's fraction is not of the class sunlit, umbra or between",
        "rows",
        mismatch([_class(value) for value in fraction], [_CLASSES.get(name, "partial") for name in classes]),
        0.0,
    )
    yield ReferenceComparison(
        "cylinder",
        "Rows where the onboard cylindrical shadow differs",
        "rows",
        _cylinder_mismatch(r_m, sun_m, table.column("lit_cylinder")),
        0.0,
    )


def _cylinder_mismatch(r_m: Array, sun_m: Array, reference: Array) -> Array:
    """1 where the shadow differs both for a cylinder along Earth to Sun and for one along satellite to Sun.

    The two are 0.3 km apart at the shadow's edge in low orbits, and a reference may mean either.
    """
    differs = np.ones(len(r_m))
    for towards_m in (sun_m, sun_m - r_m):
        directions = towards_m / np.linalg.norm(towards_m, axis=1)[:, None]
        ours = [
            lit((x, y, z), (sx, sy, sz))
            for (x, y, z), (sx, sy, sz) in zip(r_m.tolist(), directions.tolist(), strict=True)
        ]
        differs *= mismatch(ours, reference)
    return differs


_CLASSES = {"sunlit": "sunlit", "umbra": "umbra"}


def _class(fraction: float) -> str:
    return {0.0: "umbra", 1.0: "sunlit"}.get(float(fraction), "partial")


# --- tle.txt: real elements through the onboard orbit and the plant's

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


def check_elements(path: Path) -> Iterator[ClaimOutcome]:
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
