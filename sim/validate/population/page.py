"""docs/population.md and its pictures, made of flights alone."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import inf
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from sim.campaign.claim import ClaimOutcome
from sim.campaign.consistency import POINTED_DEG
from sim.campaign.flight import FlightResult
from sim.campaign.population import POPULATIONS, Tolerances
from sim.drawing.canvas import AXES_COLOURS, LIMIT, MUTED, log_y, style
from sim.record.whole_file import replacing
from sim.validate.page import claims_table, platform_line, tally
from sim.validate.population.claims import inside
from sim.validate.population.sweep import Quantity

# --- The pictures of the populations: pointing and honesty over what differs from the onboard table

HONEST_PERCENT = 99.7
"""Part of the time that a normal error is inside 3 sigma."""
DASHES = (0, (4, 3))

ACROSS = (
    ("dipole_am2", "residual dipole [A m²]", "log"),
    ("inertia_percent", "largest error of a moment of inertia [%]", "linear"),
    ("misalignment_deg", "turns of both sensors, sum [deg]", "linear"),
)
"""Figure, label and scale of each column of the picture of the satellites."""

Flights = Sequence[FlightResult]
worst_inside, mean_inside = inside(np.min), inside(np.mean)


class SizeSpread(NamedTuple):
    """What satellites of one size did: median, or mean, and worst."""

    size: float
    satellites: int
    pointing_deg: tuple[float, float]
    estimate_deg: tuple[float, float]
    inside_percent: tuple[float, float]


def spread_of(size: float, flights: Flights) -> SizeSpread:
    """Pointing and estimate by median and largest, the time inside 3 sigma by mean and worst axis."""

    def both(figure: str) -> tuple[float, float]:
        values = [flight.figures[figure] for flight in flights]
        return float(np.median(values)), float(np.max(values))

    means, worst = ([pick(flight) for flight in flights] for pick in (mean_inside, worst_inside))
    shares = (100.0 * float(np.mean(means)), 100.0 * float(np.min(worst)))
    return SizeSpread(size, len(flights), both("pointing_deg"), both("estimate_deg"), shares)


def draw_satellites(populations: Mapping[str, Flights], path: Path) -> None:
    """Pointing error above, honesty of the worst axis below, a dot for each satellite."""
    with style():
        figure = Figure(figsize=(8.2, 4.6), layout="constrained")
        above, below = figure.subplots(2, len(ACROSS), sharex="col", sharey="row")
        for (name, flights), colour in zip(populations.items(), AXES_COLOURS, strict=False):
            for column, (key, _, _) in enumerate(ACROSS):
                x = [flight.figures[key] for flight in flights]
                pointing = [flight.figures["pointing_deg"] for flight in flights]
                honesty = [100.0 * worst_inside(flight) for flight in flights]
                _dots(above[column], x, pointing, name, colour)
                _dots(below[column], x, honesty, name, colour)
        flown = [flight for flights in populations.values() for flight in flights]
        log_y(above[0], np.array([flight.figures["pointing_deg"] for flight in flown]), decades=3.0)
        for column, (_, label, scale) in enumerate(ACROSS):
            above[column].set(xscale=scale)
            below[column].set(xscale=scale, xlabel=label)
            below[column].axhline(HONEST_PERCENT, color=LIMIT, linewidth=0.8, linestyle=DASHES)
        above[0].set(ylabel="pointing error, RMS [deg]", title="Pointing, last three orbits")
        below[0].set(ylabel="time inside 3 sigma [%]", title="Honesty, worst axis; 99.7 % dashed")
        above[0].legend()
        _save(figure, path)


def draw_sweep(sweep: Mapping[Quantity, Sequence[SizeSpread]], path: Path) -> None:
    """Pointing, estimate and honesty, a row each, over the size of each quantity, a column each."""
    with style():
        figure = Figure(figsize=(8.2, 6.4), layout="constrained")
        panels = figure.subplots(len(SWEEP_ROWS), len(sweep), sharex="col", sharey="row", squeeze=False)
        for row, (label, _, title, pair) in zip(panels, SWEEP_ROWS, strict=True):
            row[0].set(ylabel=label, title=title)
            for panel, (quantity, sizes) in zip(row, sweep.items(), strict=True):
                panel.set(xscale=quantity.scale, xlim=_span(quantity))
                _both(panel, [spread.size for spread in sizes], [pair(spread) for spread in sizes])
                panel.axvline(quantity.bound, color=MUTED, linewidth=0.8, linestyle=":")
        for row, (_, is_angle, _, pair) in zip(panels, SWEEP_ROWS, strict=True):
            if is_angle:
                values = [pair(spread) for sizes in sweep.values() for spread in sizes]
                log_y(row[0], np.array(values).ravel(), decades=3.0)
            else:
                for panel in row:
                    panel.axhline(HONEST_PERCENT, color=LIMIT, linewidth=0.8, linestyle=DASHES)
        for panel, quantity in zip(panels[-1], sweep, strict=True):
            panel.set_xlabel(quantity.label)
        panels[0][0].legend()
        _save(figure, path)


SWEEP_ROWS: tuple[tuple[str, bool, str, Callable[[SizeSpread], tuple[float, float]]], ...] = (
    ("pointing error, RMS [deg]", True, "Pointing, last three orbits", lambda of: of.pointing_deg),
    ("error of the estimate, RMS [deg]", True, "Estimate", lambda of: of.estimate_deg),
    ("time inside 3 sigma [%]", False, "Honesty; 99.7 % dashed", lambda of: of.inside_percent),
)
"""Label, whether an angle, title and values of each row."""


def _span(quantity: Quantity) -> tuple[float, float]:
    """From the least to the largest size, with room for the dots."""
    least, most = quantity.sizes(2)
    if quantity.scale == "log":
        room = (most / least) ** 0.04
        return least / room, most * room
    room = 0.04 * (most - least)
    return least - room, most + room


def _both(panel: Axes, sizes: Sequence[float], values: Sequence[tuple[float, float]]) -> None:
    for number, (name, dashes) in enumerate((("median; of honesty the mean", "-"), ("worst", "--"))):
        chosen, colour = [pair[number] for pair in values], AXES_COLOURS[number]
        panel.plot(sizes, chosen, dashes, marker="o", markersize=3.0, label=name, color=colour)


def _dots(panel: Axes, x: Sequence[float], y: Sequence[float], name: str, colour: str) -> None:
    panel.plot(x, y, linestyle="none", marker="o", markersize=3.0, alpha=0.7, label=name, color=colour)


def _save(figure: Figure, path: Path) -> None:
    with replacing(path) as file:
        figure.savefig(file, format="svg", facecolor="white", metadata={"Date": None})


# --- docs/population.md

HEAD = """# Populations of real satellites

Written by `make population`; do not edit. No satellite is what its onboard table says. Here random ones fly,
drawn by `sim/campaign/population.py` within the tolerances below: the plant gets what is true, the onboard
table keeps the nominal values. Satellite 7 of a population is the same wherever it flies, and its sensors and
coils are healthy: none may be isolated. The law is `mpc`; a flight takes eight orbits, fourteen from 5 deg/s,
and begins up to 60 deg and 0.05 deg/s by axis off, where it does not tumble. The 6U has drag and light
besides. In each of them the magnetometer's bias follows orbit and shadow, a storm disturbs the field at high
latitude, coils keep some of each pulse, the dipole changes and the body snaps at the shadow's edge, and the
Sun sensor sees an Earth with clouds.

The tolerances are an own estimate, and no more than the onboard table declares, but for the population
`twice`. The dipole is that of a satellite whose own was measured: one that was not has some mA m^2 per kg
([uncertainty.md](uncertainty.md)), at 50 kg as much as the largest here or several times that; what 0.2 A m^2
does is in the table of one difference.

An honest filter has each axis of its error inside 3 sigma for 99.7 % of the time.
"""

SWEEP = """## One difference alone

Satellites of the 50 kg population, in which one quantity is given sizes from none to twice the bound that is
declared, the dotted line; all else is as drawn. The dipole keeps its direction, the error of the inertia its
shape, and the sensors turn about the same axes, the same part of their bounds each.
"""

REACHED = """RMS of the pointing error over the last three orbits. The continuous driver has the same coils
and holds any dipole up to the highest level, for half of each tick, where the others give pulses of 3 s with
a back-off of 100 s that all coils share."""

TOLERANCES = (
    ("moments of inertia, each", "inertia_percent", "%"),
    ("products of inertia, of the mean moment", "products_percent", "%"),
    ("residual dipole, any direction, log-uniform", "residual_dipole_am2", "A m^2"),
    ("what the shadow adds to the dipole, of the largest one", "eclipse_dipole_percent", "%"),
    ("remanence, of the dipole of a pulse", "remanence_percent", "%"),
    ("dipole of a coil", "coil_gain_percent", "%"),
    ("axis of a coil, whole turn", "coil_misalignment_deg", "deg"),
    ("magnetometer bias, by axis", "magnetometer_bias_nt", "nT"),
    ("amplitude of its bias over the orbit, by axis", "magnetometer_orbit_nt", "nT"),
    ("its bias in shadow, by axis", "magnetometer_shadow_nt", "nT"),
    ("magnetometer scale, by axis", "magnetometer_scale_percent", "%"),
    ("magnetometer, whole turn", "magnetometer_misalignment_deg", "deg"),
    ("magnetometer, angles between its axes, within that turn", "non_orthogonality_deg", "deg"),
    ("Sun sensor, whole turn", "sun_misalignment_deg", "deg"),
    ("light of the Earth, of sunlight", "albedo_percent", "%"),
    ("storm at high latitude", "storm_nt", "nT"),
    ("torque by axis, with its daily variation", "torque_nm", "N m"),
    ("change of the rate at the shadow's edge, by axis", "snap_radps", "rad/s"),
    ("position along the track", "along_track_km", "km"),
    ("age of the samples of both sensors", "latency_s", "s"),
)
"""Name, attribute and unit of what a population may differ by."""


def page(
    outcomes: Sequence[ClaimOutcome],
    populations: Mapping[str, Flights],
    lifted: Mapping[str, Flights],
    sweep: Mapping[Quantity, Sequence[SizeSpread]],
    pictures: Sequence[str],
    flown: str,
) -> str:
    """The page.

    Args:
        outcomes: of all claims.
        populations: the flights of each population as it is, by its name.
        lifted: those of the same satellites without the limits of pulses.
        sweep: by quantity, its sizes.
        pictures: file names of that of the satellites and that of the sweep.
        flown: how many flights it is made of, a sentence.
    """
    of_satellites, of_sweep = pictures
    lines = [HEAD, tally(outcomes) + ".", "", *claims_table(outcomes), ""]
    lines += [SWEEP, f"![pointing, estimate and honesty over the size of one difference]({of_sweep})", ""]
    lines += [*sweep_table(sweep), "", "## All differences at once", ""]
    lines += [f"![pointing and honesty of each satellite over what differs]({of_satellites})", ""]
    lines += [_row("differs within", *POPULATIONS, "unit"), "|---" * (2 + len(POPULATIONS)) + "|"]
    drawn = [chosen.tolerances for chosen in POPULATIONS.values()]
    lines += [_row(name, *(_bound(at, key) for at in drawn), unit) for name, key, unit in TOLERANCES]
    lines += ["", "## What they reach", "", REACHED, "", *reached_table({**populations, **lifted})]
    for name, flights in populations.items():
        lines += [
            "",
            f"## {name}",
            "",
            *satellites_table(flights),
            *why_not_pointed(flights, lifted.get(f"{name}_continuous", ())),
        ]
    return "\n".join([*lines, "", f"{flown} {platform_line()}.", ""])


def sweep_table(sweep: Mapping[Quantity, Sequence[SizeSpread]]) -> Iterator[str]:
    """A row for each size of each quantity."""
    yield _row("of one alone", "size", "satellites", "pointing [deg]", "estimate [deg]", "inside 3 sigma [%]")
    yield "|---" * 6 + "|"
    for quantity, sizes in sweep.items():
        for at in sizes:
            pairs = (at.pointing_deg, at.estimate_deg, at.inside_percent)
            spreads = [f"{middle:.4g}, worst {worst:.4g}" for middle, worst in pairs]
            yield _row(quantity.label, f"{at.size:.3g}", str(at.satellites), *spreads)


def satellites_table(flights: Flights) -> list[str]:
    """A row for each satellite."""
    return [_row(*COLUMNS), "|---" * len(COLUMNS) + "|", *map(_satellite, flights)]


def reached_table(populations: Mapping[str, Flights]) -> list[str]:
    """A row for each population: what share of its satellites comes within what error."""
    head = [f"within {most:g} deg [%]" for most in REACHED_DEG]
    lines = [_row("satellites", "median [deg]", *head), "|---" * (2 + len(head)) + "|"]
    for name, flights in populations.items():
        if not flights:
            continue
        errors = sorted(flight.figures["pointing_deg"] for flight in flights)
        shares = [100.0 * sum(error <= most for error in errors) / len(errors) for most in REACHED_DEG]
        lines.append(_row(name, f"{median(errors):.2f}", *(f"{share:.0f}" for share in shares)))
    return lines


def why_not_pointed(flights: Flights, lifted: Flights) -> list[str]:
    """How many never come to point, of which dipoles, and what they do without limits of pulses; or nothing.

    ``lifted``: flights of the same satellites without those limits; none: nothing says what holds them.
    """
    lost = [one for one in flights if one.figures["pointed_orbits"] == inf]
    if not lost:
        return []
    dipoles = [one.figures["dipole_am2"] for one in lost]
    sentence = (
        f"{len(lost)} of {len(flights)} never come within {POINTED_DEG:g} deg for good, for the last orbit "
        f"at least; their dipoles are {min(dipoles):.4f} to {max(dipoles):.4f} A m^2."
    )
    seeds = {one.order.seed for one in lost}
    same = [one.figures["pointing_deg"] for one in lifted if one.order.seed in seeds]
    if same:
        freed = sum(error_deg <= POINTED_DEG for error_deg in same)
        sentence += (
            f" With the continuous driver {freed} of these {len(same)} point within {POINTED_DEG:g} deg: "
            f"the back-off holds them. The other {len(same) - freed} are held by coils and law themselves."
        )
    return ["", sentence]


REACHED_DEG = (2.5, 5.0, 10.0, 20.0)
COLUMNS = (
    "satellite",
    "dipole [A m^2]",
    "inertia [%]",
    "sensors [deg]",
    "inside 3 sigma [%]",
    "NEES",
    "estimate [deg]",
    "pointing [deg]",
    "10 deg from orbit",
    "isolated",
)


def _satellite(flight: FlightResult) -> str:
    found = flight.figures
    pointed = found["pointed_orbits"]
    return _row(
        str(flight.order.seed),
        f"{found['dipole_am2']:.4f}",
        f"{found['inertia_percent']:.1f}",
        f"{found['misalignment_deg']:.2f}",
        f"{100.0 * worst_inside(flight):.1f}",
        f"{found['nees']:.1f}",
        f"{found['estimate_deg']:.2f}",
        f"{found['pointing_deg']:.2f}",
        "never" if pointed == inf else f"{pointed:.2f}",
        ", ".join(flight.summary["isolated"]) or "none",
    )


def _bound(tolerances: Tolerances, key: str) -> str:
    value = getattr(tolerances, key)
    return f"{value[0]:g} to {value[1]:g}" if isinstance(value, tuple) else f"{value:g}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"
