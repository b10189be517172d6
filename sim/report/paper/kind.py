"""The formats of figures for papers, and where they are."""

from typing import Literal

FigureKind = Literal["pdf", "svg"]
FOLDER = "figures"
"""In that of the run."""
