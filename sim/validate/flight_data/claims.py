"""The claims on flight data, and why passes miss them.

Every limit is judged over all passes whose motion the judge believes; of the others no motion is claimed. One
that misses it fails the claim, whatever the cause.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import nan
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.campaign.study import spread_of
from sim.progress import note
from sim.validate.flight_data.passes import (
    CALIBRATED_BY,
    TWO_SOLUTIONS,
    Believed,
    NotToldError,
    PassFigures,
    believed,
    carried,
    files,
    judged,
)

SOURCE = "SUCHAI-3 in orbit, 2022 to 2024: github.com/spel-uchile/Experimental-Attitude-Dataset (MIT)"
NOT_CLAIMED = (
    "Not claimed: the absolute attitude, which nothing on board shows to this accuracy; how coils act, which "
    "took no part; that normalised innovations are of the size that the filter expects. The data are public, "
    "so that this is no blind test; calibration and inertia ratios are those of 2023-12-11 alone."
)
GYRO_SCALE, GYRO_BIAS_DEGPS = 0.985, -0.20
"""gyro_y = 0.985 rate_y - 0.20 deg/s, over 22 passes."""
LONG_ROWS, SHORT_ROWS = 1000, 150

WEAK = "a field of 20 uT, in which 1 uT is 3 deg, and a minute or two to learn from"
MOMENTS = "gaps and bursts, times in whole seconds: a second of doubt is a turn of 30 to 70 deg"
OLD = "elements two weeks old: |B| is off by 2 uT, which the bias along the axis takes up"
UNKNOWN = "cause unknown"
CAUSES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {
        "coast-60": {
            "s3_20240314T153551Z": WEAK,
            "s3_20240316T151710Z": WEAK,
            "s3_20240318T145837Z": WEAK,
            "s3_20240322T154641Z": WEAK,
            "s3_20240326T150040Z": MOMENTS,
            "s3_20240327T153152Z": MOMENTS,
            "s3_20240421T034947Z": WEAK,
            "s3_20240427T161142Z": MOMENTS,
        },
        "azimuth-scatter": {"s3_20240501T155556Z": OLD},
        "azimuth": {"s3_20240501T155556Z": OLD},
    }
)
"""By claim, why a pass seems to miss it; not shown by experiment."""
APART: Mapping[str, str] = MappingProxyType({"azimuth-scatter": "s3_20230824T144409Z"})
"""Set apart before it was judged: the light of the Earth falls on cells of another scale."""


TOLD = Claim(
    "flight-data.told", "Part of the passes of 150 rows and more whose motion is told", SOURCE, "1", low=0.75
)
BELIEVED = Claim(
    "two-solutions",
    "Wrong motions, which the field alone allows, that were reported as converged",
    SOURCE,
    "1",
    high=0.0,
)


class Limit(NamedTuple):
    """A claim, and the figure of a pass that it is on; None where it is on none of that pass."""

    claim: Claim
    figure: Callable[[PassFigures], float | None]


def studies(folder: Path) -> list[Study]:
    """The passes of a folder with the calibration by one of them; where that one tells none, no claim is met.

    Raises:
        HarnessError: the folder does not hold it, or a file is malformed.
    """
    paths = files(folder)
    note(f"calibrating by {CALIBRATED_BY}")
    try:
        known = carried(folder)
    except NotToldError as error:
        missed = [claim.judge(nan, str(error)) for claim in (*(limit.claim for limit in LIMITS), TOLD)]
        without = [BELIEVED.judge(nan, str(error))]
        return [
            Study("flight-data", (), lambda nothing: missed),
            Study("two-solutions", (), lambda nothing: without),
        ]
    doubled = [path for path in paths if path.stem in TWO_SOLUTIONS]
    return [
        Study("flight-data", tuple(partial(judged, path, known) for path in paths), conclude),
        Study("two-solutions", tuple(partial(believed, path, known) for path in doubled), conclude_believed),
    ]


def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
    """The outcome of each limit, the worst of the passes; and how many motions are told, lest none is."""
    of_limits = [outcome for limit in LIMITS if (outcome := _outcome(limit, found)) is not None]
    long = [one for one in found if one.found["rows"] >= SHORT_ROWS]
    if not long:
        return of_limits
    untold = [one.name for one in long if not one.found["converged"]]
    where = f"not told: {', '.join(untold)}" if untold else ""
    return [*of_limits, TOLD.judge(1.0 - len(untold) / len(long), where)]


def _outcome(limit: Limit, found: Sequence[PassFigures]) -> ClaimOutcome | None:
    name = limit.claim.id.removeprefix("flight-data.")
    figures = {one.name: limit.figure(one) for one in found if one.name != APART.get(name)}
    values = {one: value for one, value in figures.items() if value is not None}
    if not values:
        return None
    worst, causes = list(values)[int(np.argmax(list(values.values())))], CAUSES.get(name, {})
    missed = {one: value for one, value in values.items() if not limit.claim.meets(value)}
    said = [
        f"missed by {one} {value:.3g}: {causes.get(one, 'cause unknown')}" for one, value in missed.items()
    ]
    where = "; ".join([f"worst {worst}", *said])
    return limit.claim.judge(values[worst], where, spread_of(limit.claim, list(values.values())))


def conclude_believed(found: Sequence[Any]) -> list[ClaimOutcome]:
    """No wrong motion is believed."""
    results: list[Believed] = list(found)
    where = "; ".join(
        f"{one.name}: {one.judged} offered, {', '.join(one.wrong) or 'none'}" for one in results
    )
    return [BELIEVED.judge(float(sum(len(one.wrong) for one in results)), where)]


Figure = Callable[[PassFigures], float | None]


def _of(key: str) -> Figure:
    """A figure of the passes that are believed."""
    return lambda one: one.found[key] if one.found["converged"] else None


def _if(condition: Callable[[PassFigures], bool], figure: Figure) -> Figure:
    return lambda one: figure(one) if condition(one) else None


def _carried(one: PassFigures) -> bool:
    return one.name != CALIBRATED_BY


def _in_2024(one: PassFigures) -> bool:
    return one.name.startswith("s3_2024")


def _raw_gyro(one: PassFigures) -> float | None:
    gyro = one.found["gyro_y_degps_mean"]
    if not one.found["converged"] or gyro is None:
        return None
    return float(abs(one.found["rate_y_degps_mean"] - gyro) / (0.025 * abs(gyro) + 0.1))


def _corrected_gyro(one: PassFigures) -> float | None:
    gyro = one.found["gyro_y_degps_mean"]
    if not one.found["converged"] or gyro is None:
        return None
    return float(abs(one.found["rate_y_degps_mean"] - (gyro - GYRO_BIAS_DEGPS) / GYRO_SCALE))


def _coast(horizon: str) -> Callable[[PassFigures], float | None]:
    return lambda one: one.found["coast_deg_rms"][horizon] if one.found["converged"] else None


def _azimuth(key: str) -> Callable[[PassFigures], float | None]:
    def figure(one: PassFigures) -> float | None:
        value = one.found["sun_azimuth_deg"][key]
        return abs(value) if one.found["converged"] and value is not None else None

    return figure


def _claim(name: str, statement: str, unit: str, high: float) -> Claim:
    return Claim(f"flight-data.{name}", statement, SOURCE, unit, high=high, wide="limit of the requirement")


LIMITS = (
    Limit(
        _claim("own-fit", "|B| after 9 parameters fitted to a pass of 1000 to 2000 s", "nT RMS", 700.0),
        lambda one: one.own_fit_nt if 990.0 < one.span_s < 2100.0 else None,
    ),
    Limit(
        _claim("own-fit-orbit", "|B| after 9 parameters fitted to an orbit or two", "nT RMS", 3000.0),
        lambda one: one.own_fit_nt if one.span_s > 5000.0 else None,
    ),
    Limit(
        _claim("strength", "|B| with the carried calibration and running bias, 2023", "nT RMS", 1000.0),
        _if(lambda one: not _in_2024(one), _of("field_norm_nt_rms")),
    ),
    Limit(
        _claim("strength-2024", "|B| with the carried calibration and running bias, 2024", "nT RMS", 2500.0),
        _if(_in_2024, _of("field_norm_nt_rms")),
    ),
    Limit(
        _claim("direction", "Field direction ahead of each sample, pass of the calibration", "deg RMS", 2.0),
        _if(lambda one: not _carried(one), _of("field_direction_deg_rms")),
    ),
    Limit(
        _claim("direction-carried", "The same, calibration carried, 1000 rows and more", "deg RMS", 2.5),
        _if(lambda one: _carried(one) and one.found["rows"] >= LONG_ROWS, _of("field_direction_deg_rms")),
    ),
    Limit(
        _claim("direction-short", "The same, passes of 150 to 300 rows", "deg RMS", 3.0),
        _if(lambda one: SHORT_ROWS <= one.found["rows"] < LONG_ROWS, _of("field_direction_deg_rms")),
    ),
    Limit(
        _claim("rate", "Spin rate less raw gyro, in parts of 2.5 % + 0.1 deg/s", "1", 1.0),
        _raw_gyro,
    ),
    Limit(
        _claim("rate-corrected", "Spin rate less gyro as corrected over 22 passes", "deg/s", 0.3),
        _corrected_gyro,
    ),
    Limit(_claim("coast-60", "Coasting 60 s", "deg RMS", 3.0), _coast("60")),
    Limit(_claim("coast-120", "Coasting 120 s", "deg RMS", 5.0), _coast("120")),
    Limit(
        _claim("azimuth-scatter", "Scatter of the Sun's azimuth by cells held back", "deg RMS", 5.0),
        _azimuth("rms"),
    ),
    Limit(
        _claim("azimuth", "Median of the Sun's azimuth by cells held back, size", "deg", 15.0),
        _azimuth("median"),
    ),
)


# --- The passes one by one, for the page

_PASS_HEAD = (
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


def passes_table(passes: Sequence[PassFigures]) -> list[str]:
    """The lines of a table in Markdown, and what is not claimed."""
    lines = ["| " + " | ".join(_PASS_HEAD) + " |", "|---" * len(_PASS_HEAD) + "|"]
    lines += ["| " + " | ".join(_row_of_pass(one)) + " |" for one in passes]
    return [*lines, "", NOT_CLAIMED]


def _row_of_pass(one: PassFigures) -> tuple[str, ...]:
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
        _azimuth_words(found["sun_azimuth_deg"]),
        found["told_by"] if found["converged"] else f"not converged: {found['reason']}",
    )


def _azimuth_words(azimuth: dict[str, Any]) -> str:
    if azimuth["median"] is None:
        return "-"
    return f"{azimuth['median']:.1f} ({azimuth['rms']:.1f}, {azimuth['rows']})"
