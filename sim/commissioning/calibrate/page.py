"""The page of a calibration: what is determined, what is not, and the residuals as pictures."""

import numpy as np

from sim.commissioning.calibrate.cells import CellFit
from sim.commissioning.calibrate.magnetometer import NAMES, MagnetometerFit
from sim.commissioning.calibrate.recorded import RecordedCalibration
from sim.commissioning.telemetry.time_axis import pass_time
from sim.drawing.canvas import AXES_COLOURS, TimeAxis, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import Chart, PageHeader, PageSection, Table, Tile, sections_page
from sim.drawing.time_chart import Level, Panel, Series, TimeChart, draw, time_data
from sim.value_types import Array

_DETERMINED = (
    "A number is determined if one standard deviation of it moves the field by at most 1500 nT. Neighbouring "
    "residuals are not independent: so many rows as their correlation is long count as one."
)
_DRIFT = "Each stretch for itself, the matrix as fitted; sensor axes, with standard deviations."


def calibration_page(found: RecordedCalibration, text: str) -> str:
    """The page; ``text`` is the file that was written."""
    fit, around = found.magnetometer, found.around
    finite = np.isfinite(around.recorded.mag_nt).all(axis=1)
    time = pass_time(around)
    t_s = around.t_s[finite]
    determined = fit.determined.sum()
    header = PageHeader(
        "Calibration",
        around.recorded.name,
        (f"{len(fit.residual_nt)} samples in {around.t_s[-1]:.0f} s",),
        [
            ("good", "✓ magnetometer determined")
            if determined == len(fit.determined)
            else ("bad", f"✗ {determined} of {len(fit.determined)} determined")
        ],
        [
            Tile("|B| after the fit", f"{fit.rms_nt:.0f} nT", "RMS over the pass"),
            Tile(
                "Offset", f"{np.linalg.norm(fit.offset_nt) / 1e3:.1f} µT", f"± {fit.sigma[:3].max():.0f} nT"
            ),
            Tile("Bias moves by", f"{found.drift.largest_nt:.0f} nT", "within the pass"),
        ],
    )
    with style():
        charts = [_residuals(found, time, t_s)]
    tables = (_numbers(fit), *_others(found))
    sections = [
        PageSection("numbers", "What is determined", _DETERMINED, tables),
        PageSection("residuals", "Residuals", "", (), charts),
        PageSection("drift", "Drift of the bias", _DRIFT, (_drift(found),)),
        PageSection("file", "The file", "", text=text),
    ]
    return sections_page(header, sections, time_data(time, t_s, float(around.recorded.utc_unix_s[0])))


def _residuals(found: RecordedCalibration, time: TimeAxis, t_s: Array) -> Chart:
    fit = found.magnetometer
    modelled = found.around.strength_nt[np.isfinite(found.around.recorded.mag_nt).all(axis=1)]
    panels = [
        Panel("|B| measured less modelled", "residual [nT]", 1.8,
              [Series("residual", fit.residual_nt, AXES_COLOURS[0])], levels=(Level(0.0, "none"),)),
        Panel("Strength of the field", "|B| [nT]", 1.8,
              [Series("measured, calibrated", modelled + fit.residual_nt, AXES_COLOURS[1]),
               Series("IGRF-14", modelled, AXES_COLOURS[2], 1.6)]),
    ]  # fmt: skip
    drawn = draw(time, TimeChart(t_s, panels))
    return chart("residuals", drawn.picture, "Residuals of the fit. Grey bands are eclipses.", drawn.data)


def _numbers(fit: MagnetometerFit) -> Table:
    rows = []
    for name, value, sigma, determined in zip(NAMES, fit.values, fit.sigma, fit.determined, strict=True):
        digits = 0 if name.startswith("b_") else 4
        rows.append(
            (
                name,
                f"{value:.{digits}f}",
                f"{sigma:.{digits}f}",
                "determined" if determined else "cannot be determined",
            )
        )
    rows.append(("turn", "0", "", "cannot be determined by |B|"))
    return Table(
        ("number", "value", "standard deviation", "verdict"), rows, "Magnetometer: b in nT, m without unit"
    )


def _others(found: RecordedCalibration) -> list[Table]:
    tables = []
    if found.cells:
        rows = [_cell(one) for one in found.cells]
        head = ("cell", "face, body axes", "±", "full scale", "±", "residual RMS", "rows", "verdict")
        tables.append(Table(head, rows, "Sun cells"))
    if found.body is not None:
        body = found.body
        rows = [
            (axis, f"{ratio:.5f}", f"{sigma:.5f}", "determined" if determined else "as declared")
            for axis, ratio, sigma, determined in zip(
                "xyz", body.ratios, body.ratio_sigma, body.determined, strict=True
            )
        ]
        caption = f"Moments of inertia; axes turned by ({_triple(body.turn_deg, 2)})°"
        tables.append(Table(("axis", "ratio", "standard deviation", "verdict"), rows, caption))
    return tables


def _cell(one: CellFit) -> tuple[str, ...]:
    figures = (one.full_scale, one.full_scale_sigma, one.residual_rms)
    face = (_triple(one.face_body, 3), f"{one.face_sigma_deg:.1f}°")
    return (
        one.name,
        *face,
        *(f"{figure:.{one.decimals}f}" for figure in figures),
        str(one.rows),
        "determined" if one.determined else "cannot be determined",
    )


def _drift(found: RecordedCalibration) -> Table:
    drift = found.drift
    rows = [
        (f"{middle:.0f}", *(f"{value:.0f} ± {sigma:.0f}" for value, sigma in zip(bias, sigmas, strict=True)))
        for middle, bias, sigmas in zip(drift.middle_s, drift.bias_nt, drift.sigma_nt, strict=True)
    ]
    for name, both in (("shadow less Sun", drift.eclipse_nt), ("per deg C", drift.per_degc_nt)):
        if both is not None:
            rows.append((name, *(f"{value:.0f} ± {sigma:.0f}" for value, sigma in zip(*both, strict=True))))
    return Table(("middle, s", "x, nT", "y, nT", "z, nT"), rows, "Bias less that of the whole pass")


def _triple(values: Array, decimals: int) -> str:
    return ", ".join(f"{value:.{decimals}f}" for value in values)
