"""``torquer telemetry``: the flight filter over recorded passes, in words, as JSON, as a page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.commissioning.recorded.along import placed
from sim.commissioning.recorded.calibration import UNCALIBRATED, PassCalibration, read_calibration
from sim.commissioning.recorded.columns import AXES
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.judge import Judged, figures, judge, spin_place
from sim.commissioning.telemetry.page import telemetry_page
from sim.console import answer, say
from sim.errors import HarnessError
from sim.result_files import check_results, write_result


def telemetry(path: Path, tle: Path, calibration: Path | None, page: Path | None, start_s: float) -> int:
    """Follow a recorded pass, say how well, and write the page if it is wanted.

    Returns:
        The exit code: 1 where the motion cannot be believed, else 0.

    Raises:
        HarnessError, TableError: a file cannot be read or written, is malformed, or would replace another
            of them; ``start_s`` is not positive.
    """
    if not start_s > 0.0:
        raise HarnessError(f"--start {start_s:g}: the filter starts from a positive number of seconds")
    read = {"the telemetry": path, "the element sets": tle, "the calibration": calibration}
    check_results({"--page": page}, read)
    known = UNCALIBRATED if calibration is None else read_calibration(calibration)
    judged = judged_pass(path, tle, known, start_s)
    found = figures(judged)
    for line in in_words(judged, found):
        say(line)
    if calibration is None and not judged.verdict.converged:
        say("samples are taken as they are: torquer calibrate finds what --calibration takes off them")
    if page is not None:
        write_result(page, telemetry_page(judged, known, found))
        say(f"page: {page}")
    answer({"pass": judged.around.recorded.name, **found, "page": page})
    return int(not judged.verdict.converged)


def judged_pass(path: Path, tle: Path, known: PassCalibration, start_s: float) -> Judged:
    """The pass in a file, followed and judged.

    Raises:
        HarnessError: a file cannot be read, or is malformed.
    """
    return judge(placed(read_pass(path), tle), known, Noise(), start_s)


def in_words(judged: Judged, found: dict[str, Any]) -> Sequence[str]:
    """The figures for people."""
    around, verdict = judged.around, judged.verdict
    lines = [
        f"{around.recorded.name}: {found['rows']} rows in {around.t_s[-1]:.0f} s, elements "
        f"{found['elements_age_days']:.2f} days old",
        f"field: direction {found['field_direction_deg_rms']:.2f} deg RMS ahead of each sample, "
        f"strength {found['field_norm_nt_rms']:.0f} nT RMS",
        _rate(found, spin_place(judged.axis_body)),
        "without samples: " + _coasts(found["coast_deg_rms"]),
        "Sun by cells held back: " + _azimuth(found["sun_azimuth_deg"]),
    ]
    if around.recorded.left_out:
        lines.append(around.recorded.said_left_out())
    if found["rows_of_unknown_moment"] or found["rejected"]:
        lines.append(
            f"not used: {found['rows_of_unknown_moment']} rows of one moment with others, "
            f"{found['rejected']} samples that the filter refused"
        )
    told = {"field": "by the field", "cells": "by the cells", "coasting": "by coasting"}.get(verdict.by, "")
    others = [f"{rate:.2f}" for rate in found["motions_degps"][1:]]
    if others and told:
        lines.append(f"told from {' and '.join(others)} deg/s {told}")
    lines.append("converged" if verdict.converged else f"not converged: {verdict.reason}")
    return lines


def _rate(found: dict[str, Any], place: int) -> str:
    """About the body axis that is nearest to the axis of spin."""
    said = f"rate about {AXES[place]}: {found['rate_degps_mean'][place]:.3f} deg/s"
    gyro = found["gyro_degps_mean"]
    return said if gyro is None else f"{said}, by the gyro, not used, {gyro[place]:.3f}"


def _coasts(coasts: dict[str, float | None]) -> str:
    said = [f"{error:.1f} deg after {horizon} s" for horizon, error in coasts.items() if error is not None]
    return ", ".join(said) or "the pass is too short"


def _azimuth(azimuth: dict[str, Any]) -> str:
    if azimuth["median"] is None:
        return "none with two cells lit"
    return f"azimuth off by {azimuth['median']:.1f} deg, scatter {azimuth['rms']:.1f}, {azimuth['rows']} rows"
