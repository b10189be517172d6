"""``torquer telemetry``: the flight filter over recorded passes, in words, as JSON, as a page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sim.commissioning.recorded.along import placed
from sim.commissioning.recorded.calibration import UNCALIBRATED, PassCalibration, read_calibration
from sim.commissioning.recorded.columns import AXES
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.report import CommissioningReport, in_lines
from sim.commissioning.telemetry.follow import Noise
from sim.commissioning.telemetry.judge import AllowedMotion, Judged, figures, judge, spin_place
from sim.commissioning.telemetry.time_axis import pass_time
from sim.drawing.canvas import AXES_COLOURS, MORE_COLOURS, TimeAxis, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import Chart, PageHeader, PageSection, Table, Tile, sections_page
from sim.drawing.time_chart import Level, Panel, Series, TimeChart, draw, time_data
from sim.errors import HarnessError
from sim.result_files import check_results, write_result
from sim.value_types import Array

# --- The page of a followed pass: what the filter did not use beside what it says

_METHOD = (
    "The flight filter with the magnetometer alone, from a start that the field gives. Innovations are those "
    "of the next sample, predicted before it is used; the bias is estimated on the way. Gyros and Sun cells "
    "are held back. A field that moves little fits two motions: the one that cells or coasting bear out is "
    "shown first."
)
_NOT = (
    "Not claimed: the absolute attitude, which nothing on board shows to this accuracy; how coils act, which "
    "were not used; that the normalised innovations are of the size that the filter expects."
)


def telemetry_page(judged: Judged, known: PassCalibration, found: dict[str, Any]) -> str:
    """The page of a pass with its figures."""
    around, motion, spun = judged.around, judged.best, spin_place(judged.axis_body)
    time, rows = pass_time(around), motion.followed.rows
    t_s = around.t_s[rows]
    verdict = judged.verdict
    badge = ("good", "✓ converged") if verdict.converged else ("bad", f"✗ {verdict.reason}")
    azimuth, coast = found["sun_azimuth_deg"], motion.longest_coast()
    tiles = [
        Tile("Field direction", f"{motion.direction_deg_rms:.2f}°", "RMS, predicted"),
        Tile("|B|", f"{motion.strength_nt_rms:.0f} nT", "RMS, bias estimated"),
        Tile(f"Rate about {AXES[spun]}", f"{found['rate_degps_mean'][spun]:.2f}°/s", _beside(found, spun)),
    ]
    if coast is not None:
        tiles.append(Tile("Coasting", f"{coast[1]:.1f}°", f"after {coast[0]} s"))
    if azimuth["median"] is not None:
        note = f"scatter {azimuth['rms']:.1f}°, {azimuth['rows']} rows"
        tiles.append(Tile("Sun by the cells", f"{azimuth['median']:.1f}°", note))
    facts = (
        f"{found['rows']} rows in {around.t_s[-1]:.0f} s",
        f"elements {found['elements_age_days']:.2f} days old",
        "not calibrated" if _is_raw(known) else "calibrated",
    )
    with style():
        sections = [
            PageSection("motion", "Motion", _METHOD, (_motions(judged),), [_motion_chart(judged, time, t_s)]),
            PageSection(
                "held-back",
                "What was not used",
                _NOT,
                (_coast_rows(motion),),
                [_held_chart(judged, time, t_s)],
            ),
        ]
    header = PageHeader("Recorded telemetry", around.recorded.name, facts, [badge], tiles)
    return sections_page(header, sections, time_data(time, t_s, float(around.recorded.utc_unix_s[0])))


def _is_raw(known: PassCalibration) -> bool:
    """Whether samples are taken as they are."""
    return np.array_equal(known.matrix, np.eye(3)) and not known.offset_nt.any()


def _motion_chart(judged: Judged, time: TimeAxis, t_s: Array) -> Chart:
    followed = judged.best.followed
    bias = followed.bias_nt / 1e3
    panels = [
        Panel("Field direction ahead of each sample", "angle [deg]", 1.6,
              [Series("innovation", followed.direction_deg, AXES_COLOURS[0])], 3.0),
        Panel("Strength, predicted less measured", "|B| [nT]", 1.4,
              [Series("difference", followed.strength_nt, AXES_COLOURS[1])], levels=(Level(0.0, "none"),)),
        Panel("Bias beyond the calibration", "bias [µT]", 1.4,
              [Series(axis, bias[:, n], AXES_COLOURS[n]) for n, axis in enumerate("xyz")]),
    ]  # fmt: skip
    drawn = draw(time, TimeChart(t_s, panels))
    return chart("motion", drawn.picture, "What the filter says. Grey bands are eclipses.", drawn.data)


def _held_chart(judged: Judged, time: TimeAxis, t_s: Array) -> Chart:
    motion, recorded, spun = judged.best, judged.around.recorded, spin_place(judged.axis_body)
    rates = motion.followed.rate_degps
    panels = []
    series = [Series("filter", rates[:, spun], AXES_COLOURS[0], 1.6)]
    if recorded.gyro_degps is not None:
        series.insert(
            0, Series("gyro, held back", recorded.gyro_degps[motion.followed.rows, spun], MORE_COLOURS[1])
        )
    panels.append(Panel(f"Rate about {AXES[spun]}", "rate [deg/s]", 1.6, series))
    if len(motion.azimuths.rows):
        off = np.full(len(t_s), np.nan)
        off[motion.azimuths.rows] = motion.azimuths.off_deg
        shown = Series("cells less filter", off, AXES_COLOURS[1])
        panels.append(Panel("Sun about the spin axis, by two cells", "azimuth [deg]", 1.6, [shown],
                            levels=(Level(0.0, "equal"),)))  # fmt: skip
    drawn = draw(time, TimeChart(t_s, panels))
    return chart("held-back", drawn.picture, "What was not used. Grey bands are eclipses.", drawn.data)


def _motions(judged: Judged) -> Table:
    rows = []
    for motion in judged.motions:
        rate = motion.followed.rate_degps[motion.settled :].mean(axis=0)
        coast = motion.longest_coast()
        azimuths = motion.azimuths
        rows.append(
            (
                f"({rate[0]:.2f}, {rate[1]:.2f}, {rate[2]:.2f})",
                f"{motion.direction_deg_rms:.2f}",
                "" if coast is None else f"{coast[1]:.1f} after {coast[0]} s",
                f"{azimuths.median_deg:.1f}, scatter {azimuths.scatter_deg:.1f}"
                if len(azimuths.rows)
                else "",
            )
        )
    head = ("rate, deg/s, body axes", "field direction, deg RMS", "coasting, deg RMS", "Sun by cells, deg")
    return Table(head, rows, "Motions that the field allows, the one that is shown first")


def _coast_rows(motion: AllowedMotion) -> Table:
    rows = [
        (
            f"{horizon}",
            "too short" if error is None else f"{error:.2f}",
            str(len(motion.coasts_deg.get(horizon, ()))),
        )
        for horizon, error in motion.coast_deg_rms().items()
    ]
    return Table(("without samples for, s", "field direction, deg RMS", "starts"), rows, "Coasting")


def _beside(found: dict[str, Any], spun: int) -> str:
    gyro = found["gyro_degps_mean"]
    return "no gyro" if gyro is None else f"gyro {gyro[spun]:.2f}"


# --- The command


def telemetry(
    path: Path, tle: Path, calibration: Path | None, page: Path | None, start_s: float
) -> CommissioningReport:
    """Follow a recorded pass, and write the page if it is wanted; ok where the motion can be believed.

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
    lines = in_lines(in_words(judged, found))
    if calibration is None and not judged.verdict.converged:
        said = "samples are taken as they are: torquer calibrate finds what --calibration takes off them"
        lines += in_lines([said])
    if page is not None:
        write_result(page, telemetry_page(judged, known, found))
        lines += in_lines([f"page: {page}"])
    values = {"pass": judged.around.recorded.name, **found, "page": page}
    return CommissioningReport(tuple(lines), values, judged.verdict.converged)


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
    means = {"field": "by the field", "cells": "by the cells", "coasting": "by coasting"}.get(verdict.by, "")
    others = [f"{rate:.2f}" for rate in found["motions_degps"][1:]]
    if others and means:
        lines.append(f"distinguished from {' and '.join(others)} deg/s {means}")
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
