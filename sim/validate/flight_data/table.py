"""The passes one by one, for the page."""

from collections.abc import Sequence
from typing import Any

from sim.validate.flight_data.claims import NOT_CLAIMED
from sim.validate.flight_data.passes import PassFigures

_HEAD = (
    "pass",
    "rows",
    "own fit, nT",
    "strength, nT",
    "direction, deg",
    "rate y less gyro, deg/s",
    "coasting 10, 30, 60, 120 s, deg",
    "Sun azimuth, deg (scatter, rows)",
    "told by",
)


def as_table(passes: Sequence[PassFigures]) -> list[str]:
    """The lines of a table in Markdown, and what is not claimed."""
    lines = ["| " + " | ".join(_HEAD) + " |", "|---" * len(_HEAD) + "|"]
    lines += ["| " + " | ".join(_row(one)) + " |" for one in passes]
    return [*lines, "", NOT_CLAIMED]


def _row(one: PassFigures) -> tuple[str, ...]:
    found = one.found
    coasts = ", ".join("-" if error is None else f"{error:.1f}" for error in found["coast_deg_rms"].values())
    gyro = found["gyro_y_degps_mean"]
    return (
        one.name.removeprefix("s3_"),
        str(found["rows"]),
        f"{one.own_fit_nt:.0f}",
        f"{found['field_norm_nt_rms']:.0f}",
        f"{found['field_direction_deg_rms']:.2f}",
        "-" if gyro is None else f"{found['rate_y_degps_mean']:.2f} less {gyro:.2f}",
        coasts,
        _azimuth(found["sun_azimuth_deg"]),
        found["told_by"] if found["converged"] else f"not converged: {found['reason']}",
    )


def _azimuth(azimuth: dict[str, Any]) -> str:
    if azimuth["median"] is None:
        return "-"
    return f"{azimuth['median']:.1f} ({azimuth['rms']:.1f}, {azimuth['rows']})"
