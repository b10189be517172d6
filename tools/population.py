"""Fly the populations of random satellites and write docs/population.md with its picture.

The flights and claims are those of ``torquer validate --only population``; the page shows each satellite too.
Exit code 1 when a claim fails.
"""

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fsw.input.schema import TableError
from sim.campaign.claim import ClaimVerdict
from sim.campaign.flight import FlightResult
from sim.campaign.population import POPULATIONS, Tolerances
from sim.campaign.runner import StudyResult, run
from sim.drawing.canvas import AXES_COLOURS, LIMIT, log_y, style
from sim.errors import HarnessError
from sim.progress import progress
from sim.record.destination import check_file
from sim.validate import population
from sim.validate.page import claims_table, platform_line, tally

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "population.md"

HEAD = """# Populations of real satellites

Written by `make population`; do not edit. No satellite is what its onboard table says. Here random ones fly,
drawn by `sim/campaign/population.py` within the tolerances below: the plant gets what is true, the onboard
table keeps the nominal values. Satellite 7 of a population is the same wherever it flies, and its sensors and
coils are healthy: none may be isolated. The 6U has drag and light besides. No Sun sensor sees the light of
the Earth (`sensors.sun.albedo` would turn it on).

An honest filter has each axis of its error inside 3 sigma for 99.7 % of the time.
"""

TOLERANCES = (
    ("moments of inertia, each", "inertia_percent", "%"),
    ("products of inertia, of the mean moment", "products_percent", "%"),
    ("residual dipole, any direction, log-uniform", "residual_dipole_am2", "A m^2"),
    ("part of the dipole that points elsewhere in shadow", "eclipse_dipole_percent", "%"),
    ("remanence of pulses at the highest level, of the largest dipole", "remanence_percent", "%"),
    ("dipole of a coil", "coil_gain_percent", "%"),
    ("axis of a coil, whole turn", "coil_misalignment_deg", "deg"),
    ("magnetometer bias, by axis", "magnetometer_bias_nt", "nT"),
    ("magnetometer scale, by axis", "magnetometer_scale_percent", "%"),
    ("magnetometer, whole turn", "magnetometer_misalignment_deg", "deg"),
    ("magnetometer, angles between its axes, within that turn", "non_orthogonality_deg", "deg"),
    ("Sun sensor, whole turn", "sun_misalignment_deg", "deg"),
    ("torque by axis, with its daily variation", "torque_nm", "N m"),
    ("position along the track", "along_track_km", "km"),
    ("age of the samples of both sensors", "latency_s", "s"),
)
"""Name, attribute and unit of what a population may differ by."""

ACROSS = (
    ("dipole_am2", "residual dipole [A m²]", "log"),
    ("inertia_percent", "largest error of a moment of inertia [%]", "linear"),
    ("misalignment_deg", "turns of both sensors, sum [deg]", "linear"),
)
"""Figure, label and scale of each column of the picture."""


def page(finished: Sequence[StudyResult], picture: str, wall_s: float) -> str:
    """docs/population.md."""
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    lines = [HEAD, tally(outcomes) + ".", "", *claims_table(outcomes), ""]
    lines += [f"![pointing and honesty over dipole, inertia error and misalignment]({picture})", ""]
    lines += ["## What is drawn", "", _row("differs within", *POPULATIONS, "unit"), "|---" * 5 + "|"]
    drawn = [chosen.tolerances for chosen in POPULATIONS.values()]
    lines += [_row(name, *(_bound(at, key) for at in drawn), unit) for name, key, unit in TOLERANCES]
    for name, flights in nominal_flights(finished).items():
        lines += ["", f"## {name}", "", *satellites_table(flights)]
    return "\n".join([*lines, "", f"Wall time {wall_s:.0f} s. {platform_line()}.", ""])


def nominal_flights(finished: Sequence[StudyResult]) -> dict[str, Sequence[FlightResult]]:
    """The flights of each population as it is, by its name."""
    by_id = {study.study.id.partition(".")[2]: study.results for study in finished}
    return {name: by_id[name] for name in POPULATIONS}


def satellites_table(flights: Sequence[FlightResult]) -> list[str]:
    """A row for each satellite."""
    head = ("satellite", "dipole [A m^2]", "inertia [%]", "sensors [deg]", "inside 3 sigma [%]", "NEES")
    head += ("estimate [deg]", "pointing [deg]", "10 deg from orbit", "isolated")
    return [_row(*head), "|---" * len(head) + "|", *map(_satellite, flights)]


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
        "never" if pointed == float("inf") else f"{pointed:.2f}",
        ", ".join(flight.summary["isolated"]) or "none",
    )


worst_inside = population.inside(min)


def draw(finished: Sequence[StudyResult], path: Path) -> None:
    """Pointing error above, honesty of the worst axis below, each over what differs from the table."""
    with style():
        figure = Figure(figsize=(8.2, 4.6), layout="constrained")
        above, below = figure.subplots(2, len(ACROSS), sharex="col", sharey="row")
        for number, (name, flights) in enumerate(nominal_flights(finished).items()):
            for column, (key, _, _) in enumerate(ACROSS):
                x = [flight.figures[key] for flight in flights]
                pointing = [flight.figures["pointing_deg"] for flight in flights]
                honesty = [100.0 * worst_inside(flight) for flight in flights]
                _dots(above[column], x, pointing, name, AXES_COLOURS[number])
                _dots(below[column], x, honesty, name, AXES_COLOURS[number])
        flown = [flight for flights in nominal_flights(finished).values() for flight in flights]
        log_y(above[0], np.array([flight.figures["pointing_deg"] for flight in flown]), decades=3.0)
        for column, (_, label, scale) in enumerate(ACROSS):
            above[column].set(xscale=scale)
            below[column].set(xscale=scale, xlabel=label)
            below[column].axhline(99.7, color=LIMIT, linewidth=0.8, linestyle=(0, (4, 3)))
        above[0].set(ylabel="pointing error, RMS [deg]", title="Pointing, last three orbits")
        below[0].set(ylabel="time inside 3 sigma [%]", title="Honesty, worst axis; 99.7 % dashed")
        above[0].legend()
        figure.savefig(path, facecolor="white", metadata={"Date": None})


def _dots(panel: Axes, x: Sequence[float], y: Sequence[float], name: str, colour: str) -> None:
    panel.plot(x, y, linestyle="none", marker="o", markersize=3.0, alpha=0.7, label=name, color=colour)


def _bound(tolerances: Tolerances, key: str) -> str:
    value = getattr(tolerances, key)
    return f"{value[0]:g} to {value[1]:g}" if isinstance(value, tuple) else f"{value:g}"


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def main(words: Sequence[str] | None = None) -> int:
    """Fly, judge, write the page; 1 if a claim fails."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--satellites", type=int, help="at most so many of each population; default: all")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--out", type=Path, default=PAGE, help="the page; its picture lies beside it")
    arguments = parser.parse_args(words)
    picture, began = arguments.out.with_suffix(".svg"), time.monotonic()
    try:
        check_file(arguments.out)
        check_file(picture)
        studies = population.studies(arguments.satellites)
        with progress("flying satellites", sum(len(study.tasks) for study in studies)) as watch:
            finished = run(studies, arguments.workers, watch, lambda study: None)
    except (HarnessError, TableError) as error:
        print(f"population: {error}", file=sys.stderr)
        return 2
    draw(finished, picture)
    text = page(finished, picture.name, time.monotonic() - began)
    arguments.out.write_text(text, encoding="utf-8")
    print(text)
    outcomes = [outcome for study in finished for outcome in study.outcomes]
    return int(any(outcome.verdict is ClaimVerdict.FAIL for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
