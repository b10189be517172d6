"""The live view on a terminal; where the output is no terminal, a line for each thing that happens."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from math import cos, radians, sin
from time import monotonic

from rich.bar import Bar
from rich.console import Console, RenderableType
from rich.layout import Layout
from rich.live import Live
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from fsw.core.algebra.vector import Vec3, norm
from fsw.input.error_text import line_text
from fsw.wire.messages import NAMES
from sim.watch.flight_view import FlightView, SecondSample
from sim.watch.happening import Occurrence, Weight

# --- A picture of directions in characters of a terminal: each character has two by four dots (Braille)

AZIMUTH_DEG, ELEVATION_DEG = -50.0, 25.0
"""From where the orbit axes are view: turned about the radius, then tilted towards the viewer."""
_BRAILLE = 0x2800
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))
"""Bit of a dot by its row and column in a character."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A character and the name of the arrow that it belongs to; empty: the outline."""

    text: str
    name: str


def project(vector: Vec3) -> tuple[float, float]:
    """Right and up on the picture, of a vector in orbit axes; the radius is up."""
    radius, along, normal = vector
    turn, tilt = radians(AZIMUTH_DEG), radians(ELEVATION_DEG)
    right = cos(turn) * along - sin(turn) * normal
    deep = sin(turn) * along + cos(turn) * normal
    return right, cos(tilt) * radius - sin(tilt) * deep


def picture(arrows: Mapping[str, Vec3], columns: int, rows: int) -> list[list[Cell]]:
    """Unit vectors from the middle of a circle, by rows from the top; each ends in a letter of its name.

    Args:
        arrows: by name, orbit axes; later ones are drawn over earlier ones.
        columns: of characters.
        rows: of characters.
    """
    bits = [[0] * columns for _ in range(rows)]
    names = [[""] * columns for _ in range(rows)]
    letters: dict[tuple[int, int], tuple[str, str]] = {}
    radius = max(1.0, min(columns * 2, rows * 4) / 2.0 - 4.0)

    def place(right: float, up: float) -> tuple[int, int]:
        return round(columns + right * radius), round(rows * 2 - up * radius)

    def dot(at: tuple[int, int], name: str) -> None:
        x, y = at
        if 0 <= x < columns * 2 and 0 <= y < rows * 4:
            bits[y // 4][x // 2] |= _DOTS[y % 4][x % 2]
            names[y // 4][x // 2] = name or names[y // 4][x // 2]

    for step in range(120):
        dot(place(cos(radians(3 * step)), sin(radians(3 * step))), "")
    for name, vector in arrows.items():
        right, up = project(vector)
        steps = max(2, round(radius))
        for step in range(steps + 1):
            dot(place(right * step / steps, up * step / steps), name)
        x, y = place(1.06 * right, 1.06 * up)
        letters[y // 4, x // 2] = (name[-1] if name.startswith("body") else name[0], name)
    return [
        [
            Cell(*letters[row, column])
            if (row, column) in letters
            else Cell(chr(_BRAILLE | bits[row][column]) if bits[row][column] else " ", names[row][column])
            for column in range(columns)
        ]
        for row in range(rows)
    ]


_BARS = " ▁▂▃▄▅▆▇█"


def sparkline(values: list[float | None], width: int) -> str:
    """The last values as bars between nothing and the largest of them; a gap where there is none."""
    shown = values[-width:]
    top = max((value for value in shown if value is not None), default=0.0) or 1.0
    return "".join(" " if value is None else _BARS[1 + round(7 * value / top)] for value in shown)


# --- The terminal

REFRESH_HZ = 8
LAST_ROWS = 40
"""Of the picture that stays on the terminal."""
HEAD, NUMBERS, WIDE = 3, 14, 100
"""Lines of the head, of the panels with the numbers; columns from which on courses and bars have room."""
STYLES = {Weight.PULSE: "cyan", Weight.INFO: "", Weight.WARNING: "yellow", Weight.ERROR: "bold red"}
ARROWS = {
    "body 1": "bright_blue",
    "body 2": "bright_red",
    "body 3": "bright_green",
    "nadir": "white",
    "ahead": "white",
    "field": "magenta",
    "Sun": "yellow",
    "dipole": "bright_magenta",
    "torque": "red",
}
HEAVIEST = 8
"""Messages that are listed with the load of the bus."""
OTHERS = "other identifiers"
"""Frames of unknown identifiers that are not counted each by itself."""


def show(view: FlightView, batches: Iterator[None], source: str) -> None:
    """Draw what the frames show on standard output until there is no more.

    Args:
        view: what the frames have shown.
        batches: advances to the next frames.
        source: name of bus or log.
    """
    console, source = Console(), line_text(source)
    if not console.is_terminal:
        _print_happenings(view, batches)
        return
    drawn_s = 0.0
    with Live(console=console, screen=True, auto_refresh=False) as live:
        for _ in batches:
            if monotonic() - drawn_s >= 1.0 / REFRESH_HZ:
                live.update(screen(view, source, *console.size), refresh=True)
                drawn_s = monotonic()
    console.print(screen(view, source, console.width, LAST_ROWS), height=LAST_ROWS)


def _print_happenings(view: FlightView, batches: Iterator[None]) -> None:
    shown = 0
    for _ in batches:
        for happening in view.happenings:
            if happening.number > shown:
                print(line_text(line(happening)), flush=True)
                shown = happening.number


def line(happening: Occurrence) -> str:
    """A happening as a line of text."""
    tick = "" if happening.tick is None else f"tick {happening.tick}"
    return f"{time_text(happening.unix_s)}  {tick:>12}  {happening.weight.value:7}  {happening.words}"


def short_line(happening: Occurrence) -> str:
    """The same for half a terminal: the head has day and tick, the words say whether it is a pulse."""
    grave = happening.weight in (Weight.WARNING, Weight.ERROR)
    sign = f"{happening.weight.value}: " if grave else ""
    return f"{time_text(happening.unix_s)[-8:]}  {sign}{happening.words}"


def time_text(unix_s: int | None) -> str:
    """The satellite's time in UTC."""
    return " " * 19 if unix_s is None else f"{datetime.fromtimestamp(unix_s, UTC):%Y-%m-%d %H:%M:%S}"


def screen(view: FlightView, source: str, width: int, height: int) -> RenderableType:
    """All panels, for a terminal of this size."""
    middle = min(max(NUMBERS, (height - HEAD) // 2), max(1, height - HEAD - 1))
    foot, wide = max(1, height - HEAD - middle), width >= WIDE
    layout = Layout()
    layout.split_column(
        Layout(_head(view, source), size=HEAD), Layout(name="middle", size=middle), Layout(name="foot")
    )
    layout["middle"].split_row(Layout(name="attitude"), Layout(name="numbers"))
    columns, rows = max(10, width // 2 - 4), max(4, middle - 2)
    layout["attitude"].update(Panel(_attitude(view, columns, rows), title="attitude", subtitle=_frame(view)))
    layout["numbers"].split_column(
        Layout(Panel(_coils(view, wide), title="coils"), size=6),
        Layout(Panel(_estimate(view, wide), title="estimate")),
    )
    layout["foot"].split_row(
        Layout(Panel(_happenings(view, max(1, foot - 2)), title="events and pulses"), ratio=2),
        Layout(Panel(_load(view), title="bus")),
    )
    return layout


def _head(view: FlightView, source: str) -> Panel:
    mode = "no mode yet" if view.mode is None else view.mode.name
    valid = Text("attitude valid", "green") if view.attitude else Text("attitude not valid", "bold red")
    state = "over" if view.ended else ("" if view.tick is not None else "waiting for SYNC")
    parts = (
        source,
        time_text(view.unix_s).strip(),
        f"tick {view.tick}" if view.tick is not None else "",
        mode,
    )
    words = Text("   ".join(part for part in (*parts, state) if part) + "   ", "bold")
    return Panel(words + valid)


def _frame(view: FlightView) -> str:
    return "up: radius, N: nadir, A: ahead" if view.attitude else "body axes: no valid attitude"


def _attitude(view: FlightView, columns: int, rows: int) -> Text:
    text = Text()
    for row in picture(view.arrows(), columns, rows):
        for cell in row:
            text.append(cell.text, ARROWS.get(cell.name, "bright_black"))
        text.append("\n")
    return text


def _coils(view: FlightView, wide: bool) -> Table:
    table = Table.grid(padding=(0, 2 if wide else 1), expand=True)
    for coil in range(3):
        level, lockout = view.coils.levels[coil], view.coils.lockout_ms[coil]
        if view.coils.fractions is not None:
            state: RenderableType = f"{100.0 * view.coils.fractions[coil]:+.0f} % of full"
        else:
            driven = f"{'level ' if wide else ''}{level:+d}, {view.coils.current_ma} mA"
            state = Text(driven, "bold cyan") if level else "off"
        locked = Bar(100_000, 0, lockout or 0, width=12) if lockout and wide else Text("")
        left = "" if lockout is None else (f"{lockout / 1000:.0f} s locked" if lockout else "free")
        table.add_row(f"coil {coil}", state, locked, left)
    table.add_row(f"{view.coils.pulses} pulses", f"{view.coils.refused} refused", "", "")
    return table


def _number(value: float | None, unit: str, digits: int = 2) -> str:
    return "-" if value is None else f"{value:.{digits}f} {unit}"


def _estimate(view: FlightView, wide: bool) -> Table:
    table = Table.grid(padding=(0, 2), expand=True)
    samples = list(view.samples)
    latest = samples[-1] if samples else None
    rows: tuple[tuple[str, str, str], ...] = (
        ("off nominal", "turn_deg", "deg"),
        ("3 sigma", "sigma3_deg", "deg"),
        ("rate", "rate_degps", "deg/s"),
        ("field off prediction", "field_off_deg", "deg"),
        ("Sun off prediction", "sun_off_deg", "deg"),
    )
    for title, name, unit in rows:
        value = getattr(latest, name) if latest else None
        course = sparkline(_every(samples, name), 30) if wide else ""
        table.add_row(title, _number(value, unit, 3), course)
    field = view.field
    strength = None if field is None else norm((field.b_x, field.b_y, field.b_z)) * 1e-3
    table.add_row("field", _number(strength, "uT", 1), _used(view) if wide else "")
    return table


def _every(samples: list[SecondSample], name: str) -> list[float | None]:
    """Every so many samples, so that 30 of them cover the last 20 minutes."""
    return [getattr(sample, name) for sample in samples[-1200::40]]


def _used(view: FlightView) -> str:
    quality = view.quality
    if quality is None:
        return ""
    field = "blanked" if quality.mag_blanked else ("used" if quality.mag_used else "not used")
    sun = "shadow" if quality.eclipse else ("used" if quality.sun_used else "not used")
    return f"magnetometer {field}, Sun sensor {sun}"


def _happenings(view: FlightView, most: int) -> Text:
    text = Text(no_wrap=True, overflow="ellipsis")
    for happening in list(view.happenings)[-most:]:
        text.append(short_line(happening) + "\n", STYLES[happening.weight])
    return text


def _load(view: FlightView) -> Table:
    table = Table.grid(padding=(0, 2), expand=True)
    table.add_row("125 kbit/s used", f"{100.0 * view.load.part:.1f} %")
    table.add_row("frames", f"{view.load.frames_per_s:.0f} /s")
    table.add_row("broken frames", str(view.broken))
    for can_id, count in view.frames.most_common(HEAVIEST):
        table.add_row(NAMES.get(can_id, f"0x{can_id:03X}"), str(count))
    if view.other_frames:
        table.add_row(OTHERS, str(view.other_frames))
    return table
