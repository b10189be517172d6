"""Draw the pictures of docs/design.md; with --check, exit 1 when one is stale.

docs/packages.svg and docs/core.svg: the rooms of each package on the floors that the layers contracts of
pyproject.toml give them. Arrows are the imports in the source between rooms of one package, less those that a
longer path implies; what a room imports of other packages stands in it. docs/modes.svg: the transitions of
fsw/core/modes.py, with the dwell times of fsw/flight.toml.
"""

import ast
import sys
import textwrap
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import grimp

from fsw.core.modes import TABLE
from fsw.wire.messages import Mode
from sim.record.whole_file import replace_text

ROOT = Path(__file__).resolve().parents[1]
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]

WIDTH, MARGIN, GAP = 960, 14, 12
FLOOR, ROOM, HEAD = 95, 73, 24
MOST_LINES = 5
"""That fit into a room, below its name."""
WIDEST_ROOM = 300.0
INK, FAINT, LINE, PAPER = "#1c2733", "#51606f", "#8496a8", "#ffffff"
TINT_OF_IMPORTS = "#1f5fa8"
TINTS = {
    "torquer": "#f3ecf8",
    "sim": "#eaf2fb",
    "hil_stub": "#fdf1e3",
    "fsw": "#e9f6ec",
    "fsw.core": "#e9f6ec",
}
LETTER = 5.5
"""Mean width of a small letter, in pixels."""
MOST_NAMED = 4
"""Rooms of another package that a room lists by name; where it imports more, the package stands for them."""

Floors = list[list[str]]
"""Full names of rooms by floor, the top one first."""
Places = dict[str, tuple[float, float, float]]
"""By room: left edge, top edge and width."""
Box = tuple[str, Floors, float, float, float]
"""A package, its floors, and where its box begins and how wide it is: x, y, width."""


def main(arguments: list[str]) -> int:
    pictures = {"packages": packages(), "core": core(), "modes": modes()}
    stale = []
    for name, picture in pictures.items():
        path = ROOT / "docs" / f"{name}.svg"
        if not path.is_file() or path.read_text(encoding="utf-8") != picture:
            stale.append(path.relative_to(ROOT))
            if "--check" not in arguments:
                replace_text(path, picture)
    if "--check" in arguments and stale:
        names = ", ".join(map(str, stale))
        print(f"stale: {names}: run python tools/draw_design.py", file=sys.stderr)
        return 1
    return 0


def packages() -> str:
    """torquer over sim, sim over the boards and the flight software."""
    commands, ground = floors("torquer"), floors("sim")
    top = MARGIN + box_height(len(commands)) + GAP
    bottom = top + box_height(len(ground)) + GAP
    board_width = 0.42 * (WIDTH - 2 * MARGIN - GAP)
    flight_x = MARGIN + board_width + GAP
    flight = floors("fsw")
    return drawing(
        [
            ("torquer", commands, MARGIN, MARGIN, WIDTH - 2 * MARGIN),
            ("sim", ground, MARGIN, top, WIDTH - 2 * MARGIN),
            ("hil_stub", floors("hil_stub"), MARGIN, bottom, board_width),
            ("fsw", flight, flight_x, bottom, WIDTH - MARGIN - flight_x),
        ],
        bottom + box_height(len(flight)) + MARGIN,
    )


def core() -> str:
    """The rooms of fsw.core."""
    inside = floors("fsw.core")
    height = 2 * MARGIN + box_height(len(inside))
    return drawing([("fsw.core", inside, MARGIN, MARGIN, WIDTH - 2 * MARGIN)], height)


def floors(package: str) -> Floors:
    """The layers of a package as pyproject.toml states them, without its entry point."""
    layers = next(c["layers"] for c in CONTRACTS if c.get("containers") == [package])
    rooms = [[f"{package}.{room.strip()}" for room in layer.split("|")] for layer in layers]
    return [floor for floor in rooms if floor != [f"{package}.__main__"]]


def box_height(floor_count: int) -> float:
    return HEAD + FLOOR * floor_count - (FLOOR - ROOM) + 12


def drawing(boxes: list[Box], height: float) -> str:
    svg = canvas(height)
    places: Places = {}
    for package, package_floors, x, y, width in boxes:
        add(
            svg,
            "rect",
            x=x,
            y=y,
            width=width,
            height=box_height(len(package_floors)),
            rx=8,
            fill=TINTS[package],
        )
        text(svg, x + 10, y + 18, package, size=15, weight="bold")
        places |= placed(package_floors, x + 10, y + HEAD, width - 20)
    imports = imports_between(list(places))
    for upper, lower in implied_left_out(imports):
        if package_of(upper) == package_of(lower):
            connect(svg, places, upper, lower)
    for room, place in places.items():
        outside = sorted(other for other in imports[room] if package_of(other) != package_of(room))
        draw_room(svg, room, place, outside)
    return rendered(svg)


def placed(package_floors: Floors, x: float, y: float, width: float) -> Places:
    """Rooms of a floor side by side, in the middle of it."""
    places = {}
    for number, floor in enumerate(package_floors):
        room_width = min(WIDEST_ROOM, (width - GAP * (len(floor) - 1)) / len(floor))
        left = x + (width - len(floor) * room_width - GAP * (len(floor) - 1)) / 2
        for place, room in enumerate(floor):
            places[room] = (left + place * (room_width + GAP), y + number * FLOOR, room_width)
    return places


def draw_room(
    svg: ElementTree.Element, room: str, place: tuple[float, float, float], outside: list[str]
) -> None:
    x, y, width = place
    add(svg, "rect", x=x, y=y, width=width, height=ROOM, rx=5, fill=PAPER, stroke=LINE)
    text(svg, x + 7, y + 14, room.rpartition(".")[2], size=13, weight="bold")
    letters = int((width - 12) / LETTER)
    named = textwrap.wrap("imports " + ", ".join(by_package(outside)), letters) if outside else []
    lines = textwrap.wrap(purpose(room), letters, max_lines=MOST_LINES - len(named), placeholder=" ...")
    for number, line in enumerate([*lines, *named]):
        fill = FAINT if number < len(lines) else TINT_OF_IMPORTS
        text(svg, x + 7, y + 26 + 10.5 * number, line, size=10, fill=fill)


def by_package(rooms: list[str]) -> list[str]:
    """The rooms, or their package where it has more of them than are listed by name."""
    counts = Counter(map(package_of, rooms))
    return sorted({room if counts[package_of(room)] <= MOST_NAMED else package_of(room) for room in rooms})


def package_of(room: str) -> str:
    return room.rpartition(".")[0]


def purpose(room: str) -> str:
    """The first sentence of a docstring, without its marks of code."""
    path = ROOT / room.replace(".", "/")
    source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    docstring = ast.get_docstring(ast.parse(source.read_text(encoding="utf-8"))) or ""
    return docstring.partition("\n")[0].replace("``", "").rstrip(".")


def imports_between(rooms: list[str]) -> dict[str, set[str]]:
    """By room, the other rooms that its modules import."""
    graph = grimp.build_graph("fsw", "hil_stub", "sim", "torquer", cache_dir=None)

    def room_of(module: str) -> str | None:
        return next((room for room in rooms if module == room or module.startswith(f"{room}.")), None)

    found: dict[str, set[str]] = {room: set() for room in rooms}
    for module in graph.modules:
        upper = room_of(module)
        if upper is not None:
            lower = {room_of(imported) for imported in graph.find_modules_directly_imported_by(module)}
            found[upper] |= {room for room in lower if room not in (None, upper)}
    return found


def implied_left_out(imports: dict[str, set[str]]) -> Iterator[tuple[str, str]]:
    """The transitive reduction, in a fixed order."""

    @cache
    def below(room: str) -> frozenset[str]:
        return frozenset(imports[room]).union(*(below(other) for other in imports[room]))

    for upper in sorted(imports):
        for lower in sorted(imports[upper]):
            if not any(lower in below(other) for other in imports[upper] - {lower}):
                yield upper, lower


def connect(svg: ElementTree.Element, places: Places, upper: str, lower: str) -> None:
    """An arrow from the foot of a room to the head of one below, or past the rooms of the same column."""
    (left1, top1, width1), (left2, top2, width2) = places[upper], places[lower]
    x1, y1, x2, y2 = left1 + width1 / 2, top1 + ROOM, left2 + width2 / 2, top2 - 1
    between = [x for x, y, width in places.values() if top1 < y < top2 and x < x1 < x + width]
    if between and abs(x2 - x1) < GAP:
        x1, y1, x2 = left1 + width1, top1 + ROOM / 2, x2 + 0.3 * width2
        out = x1 + 11 * (y2 - y1) / FLOOR + 10
        arrow(svg, f"M{x1:.0f},{y1:.0f} C{out:.0f},{y1:.0f} {out:.0f},{y2 - 30:.0f} {x2:.0f},{y2:.0f}")
        return
    bend = min(40.0, (y2 - y1) / 2)
    arrow(
        svg,
        f"M{x1:.0f},{y1:.0f} C{x1:.0f},{y1 + bend:.0f} {x2:.0f},{y2 - bend:.0f} {x2:.0f},{y2:.0f}",
    )


def modes() -> str:
    """Modes in a row: transitions that lead on above them, those that lead back below."""
    dwell_s = tomllib.loads((ROOT / "fsw/flight.toml").read_text(encoding="utf-8"))["modes"]
    middle_y, half, pitch = 110.0, 58.0, 236.0
    svg = canvas(340)
    centre = {mode: MARGIN + 108 + pitch * place for place, mode in enumerate(Mode)}
    transitions: dict[tuple[Mode, Mode], list[str]] = {}
    for row in TABLE:
        seconds = dwell_s.get(row.dwell)
        label = row.condition.name.lower().replace("_", " ") + (f" for {seconds:g} s" if seconds else "")
        transitions.setdefault((row.source, row.target), []).append(label)
    order = list(Mode)
    spans = {pair: order.index(pair[1]) - order.index(pair[0]) for pair in transitions}
    for (source, target), span in sorted(spans.items(), key=lambda pair_span: abs(pair_span[1])):
        side = -1.0 if span > 0 else 1.0
        shift = half * (0.45 if span > 0 else 0.5 * (abs(span) - 1) - 0.65)  # longer ones outside
        x1, x2 = centre[source] + shift, centre[target] - shift
        y = middle_y + side * 21
        depth = y + side * (78 * abs(span))
        arrow(svg, f"M{x1:.0f},{y:.0f} C{x1:.0f},{depth:.0f} {x2:.0f},{depth:.0f} {x2:.0f},{y + side:.0f}")
        label_on(svg, (x1 + x2) / 2, y + 0.75 * (depth - y), transitions[source, target])
    for mode, x in centre.items():
        box = {"x": x - half, "y": middle_y - 20, "width": 2 * half, "height": 40}
        add(svg, "rect", **box, rx=8, fill=TINTS["fsw"], stroke=LINE)
        text(svg, x, middle_y + 5, mode.name, size=14, weight="bold", anchor="middle")
    return rendered(svg)


def label_on(svg: ElementTree.Element, x: float, y: float, lines: list[str]) -> None:
    """Lines of text in the middle of an arrow, which they interrupt."""
    width, height = 7.2 * max(map(len, lines)), 14.0 * len(lines)
    add(svg, "rect", x=x - width / 2, y=y - height / 2, width=width, height=height, fill=PAPER)
    for number, line in enumerate(lines):
        text(svg, x, y - height / 2 + 11 + 14 * number, line, size=12, anchor="middle")


def canvas(height: float) -> ElementTree.Element:
    svg = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {WIDTH} {height:g}",
            "font-family": "DejaVu Sans, Helvetica, Arial, sans-serif",
        },
    )
    add(svg, "rect", width=WIDTH, height=height, fill=PAPER)
    marker = add(
        add(svg, "defs"), "marker", id="head", markerWidth=7, markerHeight=6, refX=6, refY=3, orient="auto"
    )
    add(marker, "path", d="M0,0 L7,3 L0,6 z", fill=LINE)
    return svg


def add(parent: ElementTree.Element, tag: str, **attributes: object) -> ElementTree.Element:
    values = {
        name.replace("_", "-"): f"{value:.7g}" if isinstance(value, int | float) else str(value)
        for name, value in attributes.items()
    }
    return ElementTree.SubElement(parent, tag, values)


def arrow(svg: ElementTree.Element, path: str) -> None:
    add(svg, "path", d=path, fill="none", stroke=LINE, stroke_width=1.2, marker_end="url(#head)")


def text(
    svg: ElementTree.Element,
    x: float,
    y: float,
    words: str,
    size: int,
    weight: str = "normal",
    fill: str = INK,
    anchor: str = "start",
) -> None:
    element = add(svg, "text", x=x, y=y, font_size=size, font_weight=weight, fill=fill, text_anchor=anchor)
    element.text = words


def rendered(svg: ElementTree.Element) -> str:
    ElementTree.indent(svg, " ")
    return ElementTree.tostring(svg, encoding="unicode") + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
