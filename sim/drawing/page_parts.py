"""The parts of pages as values, and the page that is made of a header and sections of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

from markupsafe import Markup

from sim.drawing.pages import page
from sim.value_types import Json


class TableCell(str):
    """A cell that is more than its text.

    Attributes:
        kind: class of style, ``good``, ``bad`` or ``note``; empty: none.
        href: address to which it links; empty: none.
    """

    __slots__ = ("href", "kind")
    kind: str
    href: str

    def __new__(cls, text: str, kind: str = "", href: str = "") -> Self:
        """The text with its style and link."""
        cell = super().__new__(cls, text)
        cell.kind, cell.href = kind, href
        return cell


class Table(NamedTuple):
    """A table of text."""

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""


class Tile(NamedTuple):
    """A figure that is looked at first."""

    name: str
    value: str
    note: str


class Chart(NamedTuple):
    """A chart as it stands on the page; without data it is a picture alone."""

    name: str
    svg: Markup
    words: str
    data: Json | None = None


@dataclass(frozen=True, slots=True)
class PageHeader:
    """What is looked at first.

    Attributes:
        kind: of page.
        name: of what it is about.
        facts: about it, in a line.
        badges: verdicts, each with its class of style: ``good``, ``bad`` or ``note``.
        tiles: figures.
    """

    kind: str
    name: str
    facts: Sequence[str] = ()
    badges: Sequence[tuple[str, str]] = ()
    tiles: Sequence[Tile] = ()


@dataclass(frozen=True, slots=True)
class PageSection:
    """A part of the page: tables and charts, what they mean in the note, text as a terminal shows it."""

    anchor: str
    title: str
    note: str = ""
    tables: Sequence[Table] = ()
    charts: Sequence[Chart] = ()
    text: str = ""


def sections_page(header: PageHeader, sections: Sequence[PageSection], time: Json | None = None) -> str:
    """The page; ``time`` is the axis of its charts against time, from ``time_chart.time_data``."""
    charts = {each.name: each.data for section in sections for each in section.charts if each.data}
    data = None if time is None else {"time": time, "charts": charts}
    return page("sim.drawing", "sections.html", data=data, header=header, sections=sections)
