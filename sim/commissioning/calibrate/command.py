"""``torquer calibrate`` of recorded telemetry: the fit in words, the file, a page with the residuals."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fsw.input.error_text import error_text
from sim.commissioning.calibrate.body import BodyFit
from sim.commissioning.calibrate.cells import CellFit
from sim.commissioning.calibrate.magnetometer import NAMES, TURN_NAMES, MagnetometerFit
from sim.commissioning.calibrate.page import calibration_page
from sim.commissioning.calibrate.recorded import LEAST_ROWS, RecordedCalibration, calibrate_pass
from sim.commissioning.recorded.along import placed
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.report import CommissioningReport, in_lines
from sim.commissioning.telemetry.follow import Noise
from sim.errors import HarnessError
from sim.result_files import check_results, write_result
from sim.value_types import Array

# --- The file that carries a calibration: values and bounds as TOML, deviations and verdicts as comments


LARGEST_BIAS_NT, LARGEST_SCALE_PERCENT = 3000.0, 10.0
"""Bounds that an onboard table admits."""


def as_toml(found: RecordedCalibration, ratios: Array) -> str:
    """The file; ``ratios``: the moments of inertia that were declared."""
    recorded, fit = found.around.recorded, found.magnetometer
    lines = [
        f"# From {error_text(recorded.name)}: {len(recorded.utc_unix_s)} rows in "
        f"{found.around.t_s[-1]:.0f} s, elements "
        f"{found.around.elements.age_days(recorded.middle_unix_s):.2f} days old.",
        "",
        "[calibration.magnetometer]",
        f"# field in body axes = matrix (raw - offset); |B| is left off by {fit.rms_nt:.0f} nT RMS",
        f"offset_nt = {_numbers(fit.offset_nt, 1)}"
        f"  # +- {_plain(fit.sigma[:3], 0)}{_inconclusive(fit.determined[:3])}",
        f"matrix = [{', '.join(_numbers(row, 6) for row in fit.matrix)}]",
        f"# xx, yy, zz, xy, xz, yz +- {_plain(fit.sigma[3:], 4)}{_inconclusive(fit.determined[3:])}",
        "# a common turn of the axes is not determined: it changes no |B|",
    ]
    for cell in found.cells:
        lines += _cell(cell) if cell.determined else []
    if found.body is not None:
        lines += _body(found.body, ratios)
    return "\n".join([*lines, "", "[uncertainty]", *_bounds(fit, found.drift.largest_nt)]) + "\n"


def _cell(cell: CellFit) -> list[str]:
    scale, sigma = (f"{value:.{cell.decimals + 1}f}" for value in (cell.full_scale, cell.full_scale_sigma))
    return [
        "",
        "[[recorded.cell]]",
        f'name = "{cell.name}"',
        f"face_body = {_numbers(cell.face_body, 4)}  # +- {cell.face_sigma_deg:.1f} deg",
        f"full_scale = {scale}  # +- {sigma}, by {cell.rows} rows",
    ]


def _body(body: BodyFit, declared: Array) -> list[str]:
    shown = ", ".join("determined" if determined else "as declared" for determined in body.determined)
    return [
        "",
        "[recorded.body]",
        f"# {shown}; declared were {_plain(declared, 5)}",
        f"inertia_ratios = {_numbers(body.ratios, 5)}",
        f"# the axis of greatest inertia +- {body.axis_sigma_deg:.1f} deg; a turn about it is not determined",
        f"principal_axes_turn_deg = {_numbers(body.turn_deg, 2)}",
    ]


def _bounds(fit: MagnetometerFit, drift_nt: float) -> list[str]:
    """Bounds of what may still be wrong: three standard deviations, and how far the bias was seen to move."""
    bias_nt = 3.0 * float(fit.sigma[:3].max()) + drift_nt
    scale = 100.0 * 3.0 * float(fit.sigma[3:6].max())
    return [
        _bound("magnetometer_bias_nt", bias_nt, LARGEST_BIAS_NT),
        _bound("magnetometer_scale_percent", scale, LARGEST_SCALE_PERCENT),
    ]


def _bound(key: str, value: float, most: float) -> str:
    said = f"  # {value:.3g} is more than a table admits" if value > most else ""
    return f"{key} = {min(value, most):.3g}{said}"


def _inconclusive(determined: Sequence[bool] | NDArray[np.bool_]) -> str:
    if all(determined):
        return ""
    return "; not determined: numbers " + ", ".join(
        str(place) for place, one in enumerate(determined, 1) if not one
    )


def _numbers(values: Array, decimals: int) -> str:
    return "[" + ", ".join(f"{value + 0.0:.{decimals}f}" for value in values) + "]"


def _plain(values: Array, decimals: int) -> str:
    return ", ".join(f"{value:.{decimals}f}" for value in values)


# --- The command

PARAMETERS = (9, 12)


def calibrate_recorded(
    path: Path, tle: Path, out: Path, page: Path | None, ratios: Sequence[float] | None, parameters: int
) -> CommissioningReport:
    """Calibrate by a CSV file of telemetry; write the tables, and the page if it is wanted.

    Args:
        path: of the telemetry.
        tle: file of element sets.
        out: TOML file to write.
        page: HTML file to write; None: none.
        ratios: declared moments of inertia; None: none are.
        parameters: of the magnetometer, 9 or 12.

    Returns:
        What was found; ok where the data tell the magnetometer.

    Raises:
        HarnessError: a file cannot be read or written, is malformed, or would replace another of them.
    """
    check_results({"--out": out, "--page": page}, {"the telemetry": path, "the element sets": tle})
    recorded = read_pass(path)
    rows = int(np.isfinite(recorded.mag_nt).all(axis=1).sum())
    if rows < LEAST_ROWS:
        raise HarnessError(f"{path}: {rows} rows with a field sample cannot tell 9 numbers, {LEAST_ROWS} may")
    around = placed(recorded, tle)
    declared = np.ones(3) if ratios is None else np.array(ratios) / max(ratios)
    found = calibrate_pass(around, declared, Noise())
    text = as_toml(found, declared)
    write_result(out, text)
    if page is not None:
        write_result(page, calibration_page(found, text))
    lines = [*_lines(found, parameters), f"written: {out}" + (f", {page}" if page is not None else "")]
    values = {**_as_json(found, parameters), "out": out, "page": page}
    return CommissioningReport(tuple(in_lines(lines)), values, bool(found.magnetometer.determined.all()))


def fault_of_ratios(ratios: Sequence[float]) -> str:
    """Why numbers are no moments of inertia of a body; empty where they are."""
    said = ",".join(f"{ratio:g}" for ratio in ratios)
    if len(ratios) != 3 or not all(1e-6 < ratio < 1e6 for ratio in ratios):
        return f"{said!r} is not three positive numbers with commas between"
    x, y, z = sorted(ratios)
    if x + y < z:
        return f"no body has the moments of inertia {said}: {x:g} + {y:g} is less than {z:g}"
    return ""


def _lines(found: RecordedCalibration, parameters: int) -> Iterator[str]:
    fit, drift = found.magnetometer, found.drift
    if left_out := found.around.recorded.said_left_out():
        yield left_out
    yield f"{len(fit.residual_nt)} samples; |B| after the fit {fit.rms_nt:.0f} nT RMS"
    for name, value, sigma, determined in zip(NAMES, fit.values, fit.sigma, fit.determined, strict=True):
        digits, unit = (0, " nT") if name.startswith("b_") else (4, "")
        said = "" if determined else "   cannot be determined from these samples"
        yield f"  {name:5} {value:10.{digits}f} +- {sigma:.{digits}f}{unit}{said}"
    if parameters == PARAMETERS[1]:
        for name in TURN_NAMES:
            yield f"  {name:5} {0.0:10.2f} deg   cannot be determined by |B|, which no turn changes"
    if not fit.determined.all():
        x, y, z = fit.weakest_axis
        yield f"  the offset is least certain along ({x:.2f}, {y:.2f}, {z:.2f}), to {fit.weakest_nt:.0f} nT"
    yield f"bias moves by up to {drift.largest_nt:.0f} nT within the pass"
    if drift.eclipse_nt is not None:
        yield f"  in shadow less in the Sun: {_triple(*drift.eclipse_nt)} nT"
    if drift.per_degc_nt is not None:
        yield f"  with temperature: {_triple(*drift.per_degc_nt)} nT/deg C"
    for cell in found.cells:
        face = ", ".join(f"{part:.3f}" for part in cell.face_body)
        digits = cell.decimals
        scale = f"full scale {cell.full_scale:.{digits}f} +- {cell.full_scale_sigma:.{digits}f}"
        said = "" if cell.determined else "; cannot be determined"
        yield f"cell {cell.name}: face ({face}) +- {cell.face_sigma_deg:.1f} deg, {scale}{said}"
    if found.body is not None:
        ratios = " : ".join(f"{ratio:.5f}" for ratio in found.body.ratios)
        yield f"inertia ratios {ratios}; axis of the greatest +- {found.body.axis_sigma_deg:.1f} deg"
    if found.judged is not None and not found.judged.verdict.converged:
        yield f"body and cells cannot be determined: {found.judged.verdict.reason}"
    elif found.judged is None:
        yield "body and cells cannot be determined: the pass is too short, or does not tell the offset"


def _triple(values: Sequence[float], sigma: Sequence[float]) -> str:
    return ", ".join(f"{value:.0f} +- {one:.0f}" for value, one in zip(values, sigma, strict=True))


def _as_json(found: RecordedCalibration, parameters: int) -> dict[str, object]:
    fit = found.magnetometer
    numbers: dict[str, dict[str, float | bool | None]] = {
        name: {"value": value, "sigma": float(sigma), "told": bool(determined)}
        for name, value, sigma, determined in zip(NAMES, fit.values, fit.sigma, fit.determined, strict=True)
    }
    if parameters == PARAMETERS[1]:
        numbers |= {name: {"value": 0.0, "sigma": None, "told": False} for name in TURN_NAMES}
    return {
        "samples": len(fit.residual_nt),
        "rows_left_out": [one._asdict() for one in found.around.recorded.left_out],
        "field_norm_nt_rms": fit.rms_nt,
        "magnetometer": numbers,
        "bias_moves_nt": found.drift.largest_nt,
        "cells": [
            one._asdict() | {"face_body": one.face_body.tolist(), "told": one.determined}
            for one in found.cells
        ],
        "inertia_ratios": None if found.body is None else found.body.ratios.tolist(),
        "principal_axes_turn_deg": None if found.body is None else found.body.turn_deg.tolist(),
    }
