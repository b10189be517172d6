"""The colours of charts on a dark page: each colour is a CSS variable that knows both."""

import re

DARK = {
    "#1b2733": "#e6ebf0",  # ink
    "#5b6b7b": "#9fb0c0",  # muted
    "#b3261e": "#ff8a80",  # limit
    "#0072b2": "#56b0ea",  # body axes
    "#d55e00": "#ff9152",
    "#009e73": "#3fd0a2",
    "#cc79a7": "#e3a0c6",  # more lines
    "#e69f00": "#f2b53a",
    "#56b4e9": "#8fd0f5",
    "#7b3fa0": "#c79be3",
    "#8a6d3b": "#c9ad78",
    "#8f9a1f": "#c6d05a",
    "#8a97a5": "#6d7b89",  # spines and ticks
    "#c9d2dc": "#303b47",  # grid
    "#dde4ee": "#232e3b",  # eclipse
    "#f7e3d3": "#4b3524",  # back-off
    "#ffffff": "#161c23",  # paper
    "#b9d4e8": "#2c4f6b",  # bands and bars of campaigns
    "#9dbfd8": "#3f6786",
    "#e4edf5": "#1f2d3a",
    "#e8e6df": "#2b3138",  # land
}
"""By the colour on a light page, as matplotlib writes it."""

_COLOUR = re.compile(r"#[0-9a-f]{6}\b")


def themed(style: str) -> str:
    """A style with its colours as variables; a colour without a dark one stays as it is."""
    return _COLOUR.sub(lambda found: _variable(found[0]), style)


def css() -> str:
    """The declarations of the variables."""
    return " ".join(f"{_name(light)}: light-dark({light}, {dark});" for light, dark in DARK.items())


def _variable(colour: str) -> str:
    return f"var({_name(colour)})" if colour in DARK else colour


def _name(colour: str) -> str:
    return f"--plot-{colour[1:]}"
