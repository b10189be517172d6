"""calibration.html: the values of a calibration, and what they leave of the samples."""

import numpy as np

from sim.commissioning.calibrate.flown.run_fit import RunCalibration
from sim.commissioning.calibrate.flown.verdicts import list_undetermined, sentences
from sim.drawing.canvas import AXES_COLOURS, INK, TimeAxis, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Tile, sections_page
from sim.drawing.time_chart import Panel, Series, TimeChart, draw, time_data


def calibration_page(
    found: RunCalibration, name: str, tick_s: float, start_unix_s: float, tables: str
) -> str:
    """The page.

    Args:
        found: the calibration.
        name: of the log.
        tick_s: length of a tick.
        start_unix_s: time of the log's first tick.
        tables: both tables as TOML; empty where none could be written.
    """
    missing = list_undetermined(found)
    badges = (
        [("bad", f"✗ {len(missing)} not determined")] if missing else [("good", "✓ everything determined")]
    )
    t_s = tick_s * (found.tick - found.tick[0]).astype(float)
    axis = TimeAxis("seconds from the start", 1.0, 0.0, float(t_s[-1]))
    with style():
        residuals = draw(axis, TimeChart(t_s, _residuals(found)))
        pulses = draw(_phase_axis(found), TimeChart(*_about_pulses(found)))
        words = (
            "What the calibration leaves of the strength of the field, and of its component along the Sun."
        )
        around = "What the coils' field and its delay leave of the readings around all pulses."
        sections = [
            PageSection(
                "values", "Values, within three standard deviations", text="\n".join(sentences(found, tick_s))
            ),
            PageSection(
                "residuals",
                "Residuals",
                charts=(chart("residuals", residuals.picture, words, residuals.data),),
            ),
            PageSection("pulses", "Around the pulses", charts=(chart("pulses", pulses.picture, around),)),
        ]
    if missing:
        sections.insert(1, PageSection("untold", "Not determined by this log", text="\n".join(missing)))
    if tables:
        sections.append(PageSection("tables", "Tables", text=tables))
    rms = np.sqrt(np.nanmean(found.residual_nt**2, axis=0))
    tiles = [
        Tile("Strength", f"{rms[0]:.0f} nT", "residual, rms"),
        Tile("Along the Sun", f"{rms[1]:.0f} nT", "residual, rms"),
        Tile("Pulses", str(sum(found.response.pulses)), "of all coils"),
        Tile("Widened", f"{found.widened:.2f}", "standard deviations, by how residuals hang together"),
    ]
    header = PageHeader("Calibration", name, (f"{len(found.tick)} smoothed samples",), badges, tiles)
    return sections_page(header, sections, time_data(axis, t_s, start_unix_s))


def _residuals(found: RunCalibration) -> tuple[Panel, Panel]:
    strength, along = found.residual_nt.T
    return (
        Panel(
            "Strength less that of the model", "[nT]", 2.0, [Series("strength", strength, AXES_COLOURS[0])]
        ),
        Panel("Component along the Sun", "[nT]", 2.0, [Series("along the Sun", along, AXES_COLOURS[1])]),
    )


def _phase_axis(found: RunCalibration) -> TimeAxis:
    phase = found.response.residual_phase
    low, high = (float(phase.min()), float(phase.max())) if len(phase) else (0.0, 1.0)
    return TimeAxis("ticks from the begin of a pulse", 1.0, low, high)


def _about_pulses(
    found: RunCalibration,
) -> tuple[np.ndarray[tuple[int], np.dtype[np.float64]], tuple[Panel, ...]]:
    """Mean and scatter of the residuals by tick of the pulse."""
    response = found.response
    ticks = np.unique(response.residual_phase)
    by_tick = [response.residual_nt[response.residual_phase == tick] for tick in ticks]
    mean = np.array([rows.mean(axis=0) for rows in by_tick]).reshape(-1, 3)
    scatter = np.array([rows.std() for rows in by_tick])
    series = [Series(f"channel {n + 1}, mean", mean[:, n], AXES_COLOURS[n]) for n in range(3)]
    return ticks, (
        Panel("Mean of all pulses", "[nT]", 2.0, series),
        Panel("Scatter", "[nT]", 1.4, [Series("all channels", scatter, INK)]),
    )
