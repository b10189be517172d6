"""hil.html: the numbers of a bench against their budgets."""

from math import isfinite

import numpy as np

from sim.drawing.canvas import AXES_COLOURS, INK, MORE_COLOURS, TimeAxis, style
from sim.drawing.inline_svg import chart
from sim.drawing.page_parts import PageHeader, PageSection, Table, Tile, sections_page
from sim.drawing.time_chart import Panel, Series, TimeChart, draw, time_data
from sim.value_types import Json

COLOURS = (*AXES_COLOURS, *MORE_COLOURS, INK)


def hil_page(numbers: Json, start_unix_s: float) -> str:
    """The page of a run on the bench, from the numbers of hil.json; ``start_unix_s``: UTC of tick 0."""
    sections = [
        PageSection("budgets", "Budgets", tables=(_budgets(numbers),)),
        PageSection("times", "Times", tables=(_times(numbers),)),
        PageSection("messages", "Messages on the bus", tables=(_messages(numbers),)),
    ]
    memory = numbers["memory"]
    samples = max((len(kib) for kib in memory["kib"].values()), default=0)
    time = None
    if samples > 1:
        t_s = memory["every_s"] * np.arange(samples)
        axis = TimeAxis("seconds from the start", 1.0, 0.0, float(t_s[-1]))
        time = time_data(axis, t_s, start_unix_s)
        with style():
            drawn = draw(axis, TimeChart(t_s, (_memory(memory["kib"], samples),)))
            words = "Resident memory of each process."
            charts = (chart("memory", drawn.picture, words, drawn.data),)
        sections.append(PageSection("memory", "Memory", charts=charts))
    facts = (
        f"{numbers['ticks']} ticks at {numbers['tick_hz']} Hz",
        f"bus {numbers['bus']}",
        "armed" if numbers["armed"] else "not armed",
        f"real boards: {', '.join(numbers['real']) or 'none'}",
        numbers["scheduling"],
    )
    header = PageHeader("Bench", numbers["scenario"], facts, _badges(numbers), _tiles(numbers))
    return sections_page(header, sections, time)


def _badges(numbers: Json) -> list[tuple[str, str]]:
    broken = sum(not line["kept"] for line in numbers["budgets"])
    badges = [("bad", f"✗ {broken} budgets broken") if broken else ("good", "✓ budgets kept")]
    badges += [("bad", f"✗ {name} ended before its time") for name in numbers["ended"]]
    if numbers["second_senders"]:
        badges.append(("bad", "✗ a second sender on the bus"))
    return badges


def _tiles(numbers: Json) -> list[Tile]:
    return [
        Tile("Jitter of SYNC", _number(numbers["jitter_ms"]["p99"]), "ms, 99 % of ticks"),
        Tile("Sensor to command", _number(numbers["latency_ms"]["p99"]), "ms, 99 % of ticks"),
        Tile("Bus load", f"{numbers['bus_load_percent']['mean']:.1f} %", "mean"),
        Tile("Ticks without an answer", str(numbers["slips"]), f"of {numbers['ticks']}"),
    ]


def _budgets(numbers: Json) -> Table:
    rows = [
        (
            line["name"],
            _number(line["measured"]),
            _number(line["allowed"]),
            "kept" if line["kept"] else "BROKEN",
        )
        for line in numbers["budgets"]
    ]
    return Table(("what", "measured", "allowed", ""), rows)


def _times(numbers: Json) -> Table:
    named = (("jitter of SYNC", numbers["jitter_ms"]), ("sensor to command", numbers["latency_ms"]))
    rows = [(name, *(_number(times[part]) for part in ("p50", "p99", "max"))) for name, times in named]
    return Table(("[ms]", "50 %", "99 %", "longest"), rows)


def _messages(numbers: Json) -> Table:
    return Table(("message", "number"), [(name, str(count)) for name, count in numbers["messages"].items()])


def _memory(kib: dict[str, list[float]], samples: int) -> Panel:
    series = [
        Series(name, _mib(values, samples), COLOURS[number % len(COLOURS)])
        for number, (name, values) in enumerate(kib.items())
    ]
    return Panel("Memory by process", "resident [MiB]", 2.4, series)


def _mib(kib: list[float], samples: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """As many samples; NaN once the process had ended."""
    mib = np.full(samples, np.nan)
    mib[: len(kib)] = np.array(kib, dtype=float) / 1024.0
    return mib


def _number(value: float) -> str:
    """Of what was not counted, a dash."""
    return f"{value:.4g}" if isfinite(value) else "–"
