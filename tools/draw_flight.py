"""Draw docs/flight.svg, the picture of the README, from the flight of the quick start.

python tools/draw_flight.py [RUN]: flies it, or reads the directory of a run.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt

import torquer
from sim.record.whole_file import replacing

TARGET = Path(__file__).resolve().parent.parent / "docs" / "flight.svg"
EVERY = 30
"""Ticks from one point of a line to the next."""
COLOURS = ("#1f6fb2", "#c2571a", "#2f8f4e")


def draw(run: torquer.Run, target: Path) -> None:
    some = {"time": slice(None, None, EVERY)}
    truth, estimate, pulses = run.truth[some], run.estimate[some], run.pulses
    figure, (angle, coils) = plt.subplots(
        2, figsize=(8.4, 4.6), sharex=True, height_ratios=(2.2, 1), layout="constrained"
    )
    angle.plot(truth.orbit, truth.pointing_deg, color=COLOURS[0], label="pointing error")
    known_deg = estimate.attitude_error_deg
    angle.plot(estimate.orbit, known_deg, color=COLOURS[1], linewidth=0.8, label="error of the estimate")
    angle.set(ylabel="deg", yscale="log", ylim=(0.01, 100.0))
    angle.yaxis.set_major_formatter("{x:g}")
    title = "50 kg satellite, 800 km, three coils: from 40 deg to half a degree"
    angle.set_title(title, fontsize=11, loc="left")
    angle.legend(loc="upper right", ncols=2, frameon=False)
    orbit_s = float(run.truth.time[-1] / run.truth.orbit[-1])
    for coil, colour in enumerate(COLOURS):
        own = pulses[pulses.coil == coil]
        coils.vlines(own.start_s / orbit_s, coil, coil + 0.14 * own.level, color=colour, linewidth=1.0)
    coils.set(xlabel="orbit", yticks=[0, 1, 2], yticklabels=["coil 0", "coil 1", "coil 2"], ylim=(-0.6, 2.6))
    coils.set_xlim(0.0, float(truth.orbit[-1]))
    for axes in (angle, coils):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    with replacing(target) as file:
        figure.savefig(file, format="svg", metadata={"Date": None})


def main(arguments: list[str]) -> None:
    mpl.rcParams.update({"svg.hashsalt": "torquer", "font.size": 9, "path.simplify_threshold": 0.5})
    if arguments:
        try:
            draw(torquer.load(arguments[0]), TARGET)
        except torquer.InputError as error:
            print(f"draw_flight: {error}", file=sys.stderr)
            sys.exit(2)
        return
    with TemporaryDirectory() as folder:
        draw(torquer.fly("microsat", orbits=4, seed=2, out=Path(folder) / "run", progress=True), TARGET)


if __name__ == "__main__":
    main(sys.argv[1:])
