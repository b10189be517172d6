"""Resident memory of every process of a bench: it must not grow once all are warm."""

import os
from collections.abc import Mapping, Sequence
from typing import Any

PAGE_KIB = os.sysconf("SC_PAGE_SIZE") // 1024
SAMPLES = 240
"""Of each process, in a run that is long enough; at most one a second."""


def resident_kib(pid: int) -> int | None:
    """Resident memory of a process [KiB]; None where it has ended, or the system does not report it."""
    try:
        with open(f"/proc/{pid}/statm", encoding="ascii") as file:
            pages = int(file.read().split()[1])
    except (OSError, IndexError):
        return None
    return pages * PAGE_KIB if pages else None  # one that has ended and is not yet waited for has none


def growth_percent(kib: Sequence[int], warm: int) -> float:
    """How far memory ever rose above that of the sample ``warm``; infinite if none comes after it."""
    later = kib[warm + 1 :]
    return 100.0 * (max(later) / kib[warm] - 1.0) if later else float("inf")


class MemoryMonitor:
    """Samples the resident memory of processes.

    Args:
        pids: of the processes, by name.
        ticks: how many the run has.
        tick_hz: ticks a second.
        warm_s: from then on memory must not grow.
        grain: only ticks that are multiples of it are sampled; 1 s without it.
    """

    def __init__(
        self, pids: Mapping[str, int], ticks: int, tick_hz: int, warm_s: float, grain: int | None = None
    ) -> None:
        self._pids = dict(pids)
        grain = tick_hz if grain is None else grain
        self._every_ticks = grain * max(1, ticks // (grain * SAMPLES))
        self._last = (ticks - 1) // self._every_ticks
        self._warm = round(warm_s * tick_hz / self._every_ticks)
        self._every_s = self._every_ticks / tick_hz
        self._kib: dict[str, list[int]] = {name: [] for name in pids}
        self._load: list[float] = []

    def sample(self, tick: int) -> None:
        """Take a sample, if one is due in this tick."""
        if tick % self._every_ticks:
            return
        self._load.append(os.getloadavg()[0])
        for name, pid in self._pids.items():
            if (kib := resident_kib(pid)) is not None:
                self._kib[name].append(kib)

    def growth_percent(self) -> dict[str, float]:
        """Of each process once warm; empty if the run ended before, or the system does not report memory."""
        if self._last <= self._warm or not any(self._kib.values()):
            return {}
        return {name: growth_percent(kib, self._warm) for name, kib in self._kib.items()}

    def history(self) -> dict[str, Any]:
        """Samples from tick 0 on, how often, which is the first that is warm, and the load of the machine."""
        return {"every_s": self._every_s, "warm": self._warm, "kib": self._kib, "load_average": self._load}


def scheduling() -> str:
    """How the system schedules this process, and with it the nodes that it starts."""
    if hasattr(os, "sched_getscheduler") and os.sched_getscheduler(0) in (os.SCHED_FIFO, os.SCHED_RR):
        return f"real time, priority {os.sched_getparam(0).sched_priority}"
    return f"ordinary, nice {os.nice(0)}"
