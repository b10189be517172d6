"""A figure of matplotlib as an SVG element that stands in an HTML page: small, without metadata."""

from collections.abc import Sequence
from io import StringIO
from itertools import groupby
from xml.etree import ElementTree

import matplotlib
from markupsafe import Markup
from matplotlib.figure import Figure

from sim.drawing.canvas import DOTS_AN_INCH, SETTINGS
from sim.drawing.page_parts import Chart
from sim.drawing.palette import themed
from sim.value_types import Json

_NUMBER = frozenset("0123456789.-e")
_UNUSED = frozenset(("metadata", "style"))
_VERBATIM = frozenset(("id", "class", "xlink:href"))
_LEAST_SCALE = 0.95
"""Of a panel on the page, beside its size as a picture: one that had to be smaller goes to the next row."""
_OF_THE_ROOT = ("width", "height", "version")
"""The page scales the picture by its ``viewBox``."""


def svg(figure: Figure, salt: str) -> str:
    """The figure as an SVG element.

    The name that ``set_gid`` gave an artist becomes the class of its group; numbers have two decimals.

    Args:
        figure: drawn within ``canvas.style``.
        salt: other than that of every other figure of the page, so that the ids are unique.
    """
    into = StringIO()
    nothing = {"Date": None, "Creator": None, "Format": None, "Type": None}
    with SETTINGS, matplotlib.rc_context({"svg.hashsalt": salt}):
        figure.savefig(into, format="svg", metadata=nothing)
    root = ElementTree.fromstring(into.getvalue())
    _simplify(root)
    for name in _OF_THE_ROOT:
        root.attrib.pop(name, None)
    return ElementTree.tostring(root, encoding="unicode")


def chart(
    name: str,
    picture: Figure | Sequence[Figure],
    words: str,
    data: Json | None = None,
    narrow: Figure | None = None,
) -> Chart:
    """A chart of a page, of figures that were drawn within ``canvas.style``.

    Args:
        name: of the chart, unique on its page.
        picture: one figure as wide as the page, or several that stand beside each other where there is room
            for them, and below each other on a narrow screen.
        words: what it shows.
        data: what the page's script draws instead.
        narrow: the same as one wide figure, for a narrow screen.
    """
    if not isinstance(picture, Figure):
        return Chart(name, _panels(name, picture), words, data)
    wide = Markup(svg(picture, name))
    if narrow is not None:
        wide = Markup('<div class="wide">{}</div><div class="narrow">{}</div>').format(
            wide, Markup(svg(narrow, f"{name}-narrow"))
        )
    return Chart(name, wide, words, data)


def _panels(name: str, figures: Sequence[Figure]) -> Markup:
    """Figures of one width, as many beside each other as the page has room for."""
    least_px = round(_LEAST_SCALE * DOTS_AN_INCH * max(figure.get_figwidth() for figure in figures))
    panels = Markup("").join(Markup(svg(figure, f"{name}-{place}")) for place, figure in enumerate(figures))
    return Markup('<div class="panels" style="--panel: {}px">{}</div>').format(least_px, panels)


def _simplify(element: ElementTree.Element) -> None:
    """Names without namespace, which HTML does not need; groups with a class or none; short numbers."""
    element.tag = _plain(element.tag)
    attributes = {_plain(name): value for name, value in element.attrib.items()}
    if element.tag == "g" and "id" in attributes:
        name = attributes.pop("id")
        if not _is_numbered(name):
            attributes = {"class": name, **attributes}
    element.attrib = {name: _written(name, value) for name, value in attributes.items()}
    element.text = (element.text or "").strip()
    for child in list(element):
        if _plain(child.tag) in _UNUSED:
            element.remove(child)
            continue
        _simplify(child)
        child.tail = "\n"


def _written(name: str, value: str) -> str:
    """An attribute: colours that suit the page, short numbers."""
    if name in _VERBATIM:
        return value
    return themed(_shortened(value)) if name == "style" else _shortened(value)


def _plain(name: str) -> str:
    """The name without its namespace; a link bears its usual prefix."""
    namespace, _, plain = name.rpartition("}")
    return f"xlink:{plain}" if namespace.endswith("xlink") else plain


def _is_numbered(name: str) -> bool:
    """Whether matplotlib has named the group, as ``axes_1``."""
    return name.rpartition("_")[2].isdigit()


def _shortened(value: str) -> str:
    """The text with its decimal numbers rounded to hundredths."""
    return "".join(_short("".join(run)) for _, run in groupby(value, _NUMBER.__contains__))


def _short(run: str) -> str:
    if "." not in run:
        return run
    try:
        text = f"{float(run):.2f}".rstrip("0").rstrip(".")
    except ValueError:
        return run
    return "0" if text == "-0" else text
