"""The formats of figures for papers, and the folder in which they are."""

from pathlib import Path
from typing import Literal

from sim.errors import HarnessError
from sim.record.destination import check_folder

FigureKind = Literal["pdf", "svg"]
FOLDER = "figures"
"""In that of the run."""


def figure_folder(run: Path) -> Path:
    """The folder, made if it is not there.

    Raises:
        HarnessError: it cannot be written, or is a link, which may lead out of the run.
    """
    folder = run / FOLDER
    if folder.is_symlink():
        raise HarnessError(f"{folder} is a symbolic link, through which nothing is written")
    check_folder(folder)
    return folder
