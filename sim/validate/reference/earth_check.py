"""earth_sun.csv: the Earth's rotation and the Sun, in both implementations."""

from collections.abc import Iterator

import numpy as np

from fsw.core.orbit import earth as onboard_earth
from fsw.core.orbit import sun as onboard_sun
from sim.plant.environment import earth as plant_earth
from sim.plant.environment.orbit import DAY_S, UNIX_EPOCH_JD
from sim.plant.environment.sun import sun_eci_m
from sim.validate.reference.comparison import ReferenceComparison, angle_rad, largest
from sim.validate.reference.reference_table import ReferenceTable, names_of
from sim.value_types import Array

ROTATION_RAD = 1e-9
"""Both are the same closed formula; a double holds the time to 2e-11 rad."""
SUN_RAD = 3e-4
"""The almanac's formula is good to 0.01 deg; mean and true equinox of date are as far apart again."""
SUN_DISTANCE = 1e-4
"""Relative, of the same formula."""
INDICES = [f"{row}{column}" for row in (1, 2, 3) for column in (1, 2, 3)]


def check(table: ReferenceTable) -> Iterator[ReferenceComparison]:
    """Compare rotation, Sun and distance at every row.

    Raises:
        HarnessError: a row is malformed.
    """
    day, fraction = table.columns("jd_utc1", "jd_utc2").T
    unix_s = (day - UNIX_EPOCH_JD) * DAY_S + fraction * DAY_S
    yield from _rotation(table, unix_s)
    yield from _sun(table, unix_s)


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


def _sun(table: ReferenceTable, unix_s: Array) -> Iterator[ReferenceComparison]:
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
