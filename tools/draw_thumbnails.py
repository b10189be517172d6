"""Draw the thumbnails of the gallery from its examples, so that documentation built without flights has them.

python tools/draw_thumbnails.py [NAME ...]: runs all examples, or those named, and draws the first figure.
"""

import runpy
import sys
from os import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from sim.record.whole_file import replacing

ROOT = Path(__file__).resolve().parent.parent
EXAMPLES, TARGET = ROOT / "examples" / "gallery", ROOT / "docs" / "_static" / "gallery"
SIZE_IN, DOTS_PER_INCH = (4.0, 2.8), 100
"""The shape of a thumbnail in the gallery, 400 by 280."""


def first_figure(example: Path) -> Figure | None:
    """The first figure that an example draws; None where it draws none. What it writes is thrown away."""
    plt.close("all")
    with TemporaryDirectory() as folder:
        here = Path.cwd()
        chdir(folder)
        try:
            runpy.run_path(str(example))
        finally:
            chdir(here)
    return plt.figure(plt.get_fignums()[0]) if plt.get_fignums() else None


def draw(figure: Figure, target: Path) -> None:
    """The figure in the size of a thumbnail, on white, which suits a dark page too."""
    figure.set_size_inches(*SIZE_IN)
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as file:
        figure.savefig(
            file, format="png", dpi=DOTS_PER_INCH, facecolor="white", metadata={"Software": "torquer"}
        )


def main(names: list[str]) -> None:
    for example in sorted(EXAMPLES.glob("plot_*.py")):
        if names and example.stem not in names:
            continue
        figure = first_figure(example)
        if figure is not None:
            draw(figure, TARGET / f"{example.stem}.png")
            print(TARGET / f"{example.stem}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
