"""Whether elements are those of an orbit while they are flown: SGP4 goes on after a decay."""

from datetime import UTC, datetime
from math import pi
from typing import Any

from sgp4.api import SGP4_ERRORS

from fsw.core.algebra.vector import norm
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.propagation import (
    ElementOrbit,
    TleOrbit,
    axis_holds,
    axis_km,
    mean_axis_km,
    sgp4_orbit,
)
from fsw.core.orbit.tle import DAY_S, UNIX_EPOCH_JD

LEAST_ALTITUDE_KM = 150.0
"""Above the equatorial radius; below it air ends an orbit within hours."""
MOMENTS, PLACES = 16, 32
"""Parts of a flight, and places along one revolution from each, at which an orbit is judged."""


def check_tle(tle: tuple[str, str] | None, begin_unix_s: float, end_unix_s: float) -> None:
    """Check the two lines of a table, if it has any, as ``check_flown`` does.

    Raises:
        ValueError: as there; the message names the key.
    """
    if tle is None:
        return
    try:
        check_flown(sgp4_orbit(*tle), begin_unix_s, end_unix_s)
    except ValueError as error:
        raise ValueError(f"orbit.tle: {error}") from None


def check_flown(orbit: TleOrbit | ElementOrbit, begin_unix_s: float, end_unix_s: float) -> None:
    """Check that elements are those of an orbit from the beginning of a flight to its end.

    Raises:
        ValueError: SGP4 gives none, it is below ``LEAST_ALTITUDE_KM``, or its semi-major axis is not that of
            the mean motion; with the altitude and the time, UTC.
    """
    step_s = (end_unix_s - begin_unix_s) / MOMENTS
    for number in range(MOMENTS + 1 if step_s > 0.0 else 1):
        _check_revolution(orbit.satellite, begin_unix_s + number * step_s)


def _check_revolution(satellite: Any, begin_unix_s: float) -> None:  # noqa: ANN401  (of a library without types)
    period_s = 120.0 * pi / satellite.no_kozai
    for place in range(PLACES):
        unix_s = begin_unix_s + place * period_s / PLACES
        days, seconds = divmod(unix_s, DAY_S)
        error, r_km, v_kmps = satellite.sgp4(UNIX_EPOCH_JD + days, seconds / DAY_S)
        when = _when(satellite, unix_s)
        if error:
            raise ValueError(f"SGP4 has no orbit {when}: {SGP4_ERRORS[error]}")
        altitude_km = norm(r_km) - RADIUS_M / 1000.0
        if altitude_km < LEAST_ALTITUDE_KM:
            raise ValueError(
                f"the elements are at {altitude_km:.1f} km {when}: at least {LEAST_ALTITUDE_KM:g} km are "
                "flown; have they decayed?"
            )
        osculating_km = axis_km(satellite, r_km, v_kmps)
        if not axis_holds(satellite, osculating_km):
            raise ValueError(
                f"the elements are at {altitude_km:.0f} km {when}, with a semi-major axis of "
                f"{osculating_km:.0f} km, and their mean motion is that of {mean_axis_km(satellite):.0f} km: "
                "they do not hold so far from their epoch"
            )


def _when(satellite: Any, unix_s: float) -> str:  # noqa: ANN401  (of a library without types)
    days = unix_s / DAY_S - (satellite.jdsatepoch - UNIX_EPOCH_JD) - satellite.jdsatepochF
    side = "after" if days >= 0.0 else "before"
    utc = datetime.fromtimestamp(int(unix_s), UTC)
    return f"on {utc:%Y-%m-%d %H:%M:%S} UTC, {abs(days):.1f} days {side} their epoch"
