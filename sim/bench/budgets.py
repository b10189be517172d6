"""The budgets of a bench: what was measured against what is allowed, as text and as JSON."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sim.bench.bus_load import BITRATE
from sim.bench.realtime_loop import BenchMeasurements, TimeHistogram
from sim.value_types import Json


@dataclass(frozen=True, slots=True)
class Budgets:
    """What is allowed: 99th percentiles of times [ms], ticks, mean load of the bus [%], memory [%].

    ``slips``: of unanswered ticks, and of ticks without the sample of each board; ``memory_percent``: how far
    the memory of each process may rise once it is warm.
    """

    jitter_ms: float
    latency_ms: float
    slips: int
    load_percent: float
    memory_percent: float


class BudgetLine(NamedTuple):
    """One budget: its name, what was measured, what is allowed."""

    name: str
    measured: float
    allowed: float

    @property
    def kept(self) -> bool:
        """Whether the budget is kept; what could not be measured is not."""
        return self.measured <= self.allowed


def percentiles(times: TimeHistogram) -> Json:
    """p50, p99 and max in ms; infinite where nothing was counted."""
    return {name: 1000.0 * times.quantile(part) for name, part in (("p50", 0.5), ("p99", 0.99), ("max", 1.0))}


def judge(
    measured: BenchMeasurements,
    budgets: Budgets,
    boards: Sequence[str],
    tick_hz: int,
    growth_percent: Mapping[str, float],
) -> tuple[Json, list[BudgetLine]]:
    """The numbers, and the budgets judged by them; ``growth_percent``: of the memory of each process."""
    jitter, latency = percentiles(measured.jitter), percentiles(measured.latency)
    seconds = measured.ticks / tick_hz
    load = 100.0 * measured.bits / (BITRATE * seconds) if seconds else 0.0
    busiest = 100.0 * measured.busiest_bits * tick_hz / BITRATE
    missing = {board: measured.ticks - measured.samples[board] for board in boards}
    numbers: Json = {
        "ticks": measured.ticks,
        "jitter_ms": jitter,
        "latency_ms": latency,
        "slips": measured.slips,
        "missing_samples": missing,
        "bus_load_percent": {"mean": load, "busiest_tick": busiest, "bitrate": BITRATE},
        "messages": dict(sorted(measured.messages.items())),
    }
    lines = [
        BudgetLine("jitter of SYNC, p99 [ms]", jitter["p99"], budgets.jitter_ms),
        BudgetLine("SYNC to TICK_DONE, p99 [ms]", latency["p99"], budgets.latency_ms),
        BudgetLine("ticks without an answer", measured.slips, budgets.slips),
        *(
            BudgetLine(f"ticks without one {board} sample", number, budgets.slips)
            for board, number in missing.items()
        ),
        BudgetLine(f"bus load at {BITRATE // 1000} kbit/s, mean [%]", load, budgets.load_percent),
        *(
            BudgetLine(f"memory of {name}, growth [%]", growth, budgets.memory_percent)
            for name, growth in growth_percent.items()
        ),
    ]
    return numbers, lines


def render(numbers: Json, lines: Sequence[BudgetLine]) -> str:
    """The table as text."""
    jitter, latency, load = numbers["jitter_ms"], numbers["latency_ms"], numbers["bus_load_percent"]
    messages = numbers["messages"]
    text = [f"{'[ms]':<32}{'p50':>10}{'p99':>10}{'max':>10}"]
    for name, times in (("jitter of SYNC", jitter), ("sensor to command", latency)):
        text.append(f"{name:<32}" + "".join(f"{times[part]:>10.3f}" for part in ("p50", "p99", "max")))
    text.append(f"bus load: mean {load['mean']:.1f} %, busiest tick {load['busiest_tick']:.1f} %")
    requested, refused = messages.get("COIL_FIRE", 0), messages.get("COIL_REFUSED", 0)
    events = sum(number for name, number in messages.items() if name.endswith("_EVENT"))
    text.append(f"{numbers['ticks']} ticks, {requested} pulses requested, {refused} refused, {events} events")
    for line in lines:
        mark = "ok" if line.kept else "BROKEN"
        text.append(f"{mark:<8}{line.name:<36}{line.measured:>10.4g}  budget {line.allowed:g}")
    return "\n".join(text)
