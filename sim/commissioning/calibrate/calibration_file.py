"""The file that carries a calibration: values and bounds as TOML, deviations and verdicts as comments."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fsw.input.error_text import error_text
from sim.commissioning.calibrate.body import BodyFit
from sim.commissioning.calibrate.cells import CellFit
from sim.commissioning.calibrate.magnetometer import MagnetometerFit
from sim.commissioning.calibrate.recorded import RecordedCalibration

Array = NDArray[np.float64]

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
        f"offset_nt = {_numbers(fit.offset_nt, 1)}  # +- {_plain(fit.sigma[:3], 0)}{_untold(fit.told[:3])}",
        f"matrix = [{', '.join(_numbers(row, 6) for row in fit.matrix)}]",
        f"# xx, yy, zz, xy, xz, yz +- {_plain(fit.sigma[3:], 4)}{_untold(fit.told[3:])}",
        "# a common turn of the axes is not told: it changes no |B|",
    ]
    for cell in found.cells:
        lines += _cell(cell) if cell.told else []
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
    shown = ", ".join("told" if told else "as declared" for told in body.told)
    return [
        "",
        "[recorded.body]",
        f"# {shown}; declared were {_plain(declared, 5)}",
        f"inertia_ratios = {_numbers(body.ratios, 5)}",
        f"# the axis of greatest inertia +- {body.axis_sigma_deg:.1f} deg; a turn about it is not told",
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


def _untold(told: Sequence[bool] | NDArray[np.bool_]) -> str:
    if all(told):
        return ""
    return "; not told: numbers " + ", ".join(str(place) for place, one in enumerate(told, 1) if not one)


def _numbers(values: Array, decimals: int) -> str:
    return "[" + ", ".join(f"{value + 0.0:.{decimals}f}" for value in values) + "]"


def _plain(values: Array, decimals: int) -> str:
    return ", ".join(f"{value:.{decimals}f}" for value in values)
