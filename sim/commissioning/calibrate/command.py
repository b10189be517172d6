"""``torquer calibrate`` of recorded telemetry: the fit in words, the file, a page with the residuals."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sim.commissioning.calibrate.calibration_file import as_toml
from sim.commissioning.calibrate.magnetometer import NAMES, TURN_NAMES
from sim.commissioning.calibrate.page import calibration_page
from sim.commissioning.calibrate.recorded import LEAST_ROWS, RecordedCalibration, calibrate_pass
from sim.commissioning.recorded.along import placed
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise
from sim.console import answer, say
from sim.errors import HarnessError
from sim.result_files import check_results, write_result

PARAMETERS = (9, 12)


def calibrate_recorded(
    path: Path, tle: Path, out: Path, page: Path | None, ratios: Sequence[float] | None, parameters: int
) -> int:
    """Calibrate by a CSV file of telemetry; write the tables, and the page if it is wanted.

    Args:
        path: of the telemetry.
        tle: file of element sets.
        out: TOML file to write.
        page: HTML file to write; None: none.
        ratios: declared moments of inertia; None: none are.
        parameters: of the magnetometer, 9 or 12.

    Returns:
        The exit code: 1 where the data do not tell the magnetometer, else 0.

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
    _say(found, parameters)
    say(f"written: {out}" + (f", {page}" if page is not None else ""))
    answer({**_as_json(found, parameters), "out": out, "page": page})
    return int(not found.magnetometer.told.all())


def _say(found: RecordedCalibration, parameters: int) -> None:
    fit, drift = found.magnetometer, found.drift
    if left_out := found.around.recorded.said_left_out():
        say(left_out)
    say(f"{len(fit.residual_nt)} samples; |B| after the fit {fit.rms_nt:.0f} nT RMS")
    for name, value, sigma, told in zip(NAMES, fit.values, fit.sigma, fit.told, strict=True):
        digits, unit = (0, " nT") if name.startswith("b_") else (4, "")
        said = "" if told else "   cannot be told from these samples"
        say(f"  {name:5} {value:10.{digits}f} +- {sigma:.{digits}f}{unit}{said}")
    if parameters == PARAMETERS[1]:
        for name in TURN_NAMES:
            say(f"  {name:5} {0.0:10.2f} deg   cannot be told by |B|, which no turn changes")
    if not fit.told.all():
        x, y, z = fit.weakest_axis
        say(f"  the offset is told least along ({x:.2f}, {y:.2f}, {z:.2f}), to {fit.weakest_nt:.0f} nT")
    say(f"bias moves by up to {drift.largest_nt:.0f} nT within the pass")
    if drift.eclipse_nt is not None:
        say(f"  in shadow less in the Sun: {_triple(*drift.eclipse_nt)} nT")
    if drift.per_degc_nt is not None:
        say(f"  with temperature: {_triple(*drift.per_degc_nt)} nT/deg C")
    for cell in found.cells:
        face = ", ".join(f"{part:.3f}" for part in cell.face_body)
        digits = cell.decimals
        scale = f"full scale {cell.full_scale:.{digits}f} +- {cell.full_scale_sigma:.{digits}f}"
        said = "" if cell.told else "; cannot be told"
        say(f"cell {cell.name}: face ({face}) +- {cell.face_sigma_deg:.1f} deg, {scale}{said}")
    if found.body is not None:
        ratios = " : ".join(f"{ratio:.5f}" for ratio in found.body.ratios)
        say(f"inertia ratios {ratios}; axis of the greatest +- {found.body.axis_sigma_deg:.1f} deg")
    if found.judged is not None and not found.judged.verdict.converged:
        say(f"body and cells cannot be told: {found.judged.verdict.reason}")
    elif found.judged is None:
        say("body and cells cannot be told: the pass is too short, or does not tell the offset")


def _triple(values: Sequence[float], sigma: Sequence[float]) -> str:
    return ", ".join(f"{value:.0f} +- {one:.0f}" for value, one in zip(values, sigma, strict=True))


def _as_json(found: RecordedCalibration, parameters: int) -> dict[str, object]:
    fit = found.magnetometer
    numbers: dict[str, dict[str, float | bool | None]] = {
        name: {"value": value, "sigma": float(sigma), "told": bool(told)}
        for name, value, sigma, told in zip(NAMES, fit.values, fit.sigma, fit.told, strict=True)
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
            one._asdict() | {"face_body": one.face_body.tolist(), "told": one.told} for one in found.cells
        ],
        "inertia_ratios": None if found.body is None else found.body.ratios.tolist(),
        "principal_axes_turn_deg": None if found.body is None else found.body.turn_deg.tolist(),
    }
