"""``torquer calibrate`` of recorded telemetry: the fit in words, the file, a page with the residuals."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sim.commissioning.calibrate.calibration_file import as_toml
from sim.commissioning.calibrate.magnetometer import NAMES, TURN_NAMES, MagnetometerFit
from sim.commissioning.calibrate.page import calibration_page
from sim.commissioning.calibrate.recorded import LEAST_ROWS, RecordedCalibration, calibrate_pass
from sim.commissioning.recorded.along import along
from sim.commissioning.recorded.element_sets import nearest_elements
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise
from sim.console import answer, say, warn
from sim.errors import HarnessError
from sim.record.destination import check_file

OLD_DAYS = 7.0
"""Elements further away put the satellite tens of kilometres off: 10 nT and more each."""
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
        HarnessError: a file cannot be read or written, or is malformed.
    """
    for file in filter(None, (out, page)):
        check_file(file)
    recorded = read_pass(path)
    if len(recorded.utc_unix_s) < LEAST_ROWS:
        raise HarnessError(f"{path}: {len(recorded.utc_unix_s)} rows cannot tell 9 numbers, {LEAST_ROWS} may")
    around = along(recorded, nearest_elements(tle, recorded.middle_unix_s))
    age_days = around.elements.age_days(recorded.middle_unix_s)
    if abs(age_days) > OLD_DAYS:
        warn(f"{tle}: the nearest element set is {abs(age_days):.0f} days away: its field may be off")
    declared = np.ones(3) if ratios is None else np.array(ratios) / max(ratios)
    found = calibrate_pass(around, declared, Noise())
    text = as_toml(found, declared)
    try:
        out.write_text(text, encoding="utf-8")
        if page is not None:
            page.write_text(calibration_page(found, text), encoding="utf-8")
    except OSError as error:
        raise HarnessError(f"{error.filename}: cannot be written ({error.strerror})") from None
    _say(found, parameters)
    say(f"written: {out}" + (f", {page}" if page is not None else ""))
    answer({**_as_json(found, parameters), "out": out, "page": page})
    return int(not found.magnetometer.told.all())


def _say(found: RecordedCalibration, parameters: int) -> None:
    fit, drift = found.magnetometer, found.drift
    say(f"{len(fit.residual_nt)} samples; |B| after the fit {fit.rms_nt:.0f} nT RMS")
    for name, value, sigma, told in zip(NAMES, _values(fit), fit.sigma, fit.told, strict=True):
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
        scale = f"full scale {cell.full_scale:.0f} +- {cell.full_scale_sigma:.0f}"
        said = "" if cell.told else "; cannot be told"
        say(f"cell {cell.name}: face ({face}) +- {cell.face_sigma_deg:.1f} deg, {scale}{said}")
    if found.body is not None:
        ratios = " : ".join(f"{ratio:.5f}" for ratio in found.body.ratios)
        say(f"inertia ratios {ratios}; axis of the greatest +- {found.body.axis_sigma_deg:.1f} deg")
    if found.judged is not None and not found.judged.verdict.converged:
        say(f"body and cells cannot be told: {found.judged.verdict.reason}")
    elif found.judged is None:
        say("body and cells cannot be told: the pass is too short, or does not tell the offset")


def _values(fit: MagnetometerFit) -> list[float]:
    m = fit.matrix
    return [
        *fit.offset_nt.tolist(),
        *(float(m[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))),
    ]


def _triple(values: Sequence[float], sigma: Sequence[float]) -> str:
    return ", ".join(f"{value:.0f} +- {one:.0f}" for value, one in zip(values, sigma, strict=True))


def _as_json(found: RecordedCalibration, parameters: int) -> dict[str, object]:
    fit = found.magnetometer
    numbers: dict[str, dict[str, float | bool | None]] = {
        name: {"value": value, "sigma": float(sigma), "told": bool(told)}
        for name, value, sigma, told in zip(NAMES, _values(fit), fit.sigma, fit.told, strict=True)
    }
    if parameters == PARAMETERS[1]:
        numbers |= {name: {"value": 0.0, "sigma": None, "told": False} for name in TURN_NAMES}
    return {
        "samples": len(fit.residual_nt),
        "field_norm_nt_rms": fit.rms_nt,
        "magnetometer": numbers,
        "bias_moves_nt": found.drift.largest_nt,
        "cells": [
            one._asdict() | {"face_body": one.face_body.tolist(), "told": one.told} for one in found.cells
        ],
        "inertia_ratios": None if found.body is None else found.body.ratios.tolist(),
        "principal_axes_turn_deg": None if found.body is None else found.body.turn_deg.tolist(),
    }
