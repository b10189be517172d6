"""The watch over one unit: evidence against it while it is in use, and for it while it is isolated."""

from dataclasses import dataclass
from typing import Final, final

from fsw.core.fdir.evidence import EvidenceWeights, weigh
from fsw.core.fdir.faults import SensorFault

LOST: Final = 0.5
"""Fraction of its weight that a missing sample has: the bus may lose some, in bursts."""


@final
@dataclass(slots=True)
class Watch:
    """One sensor: its fault (0: none), and the evidence against it; while it is isolated, for it; nats."""

    fault: int = 0
    nats: float = 0.0


def accuse(watch: Watch, cause: int, unclear: bool, weights: EvidenceWeights) -> None:
    """Judge a sensor in use: ``cause`` speaks against it, 0: nothing does; or it is unclear what."""
    by = -weights.against
    if unclear:
        by = 0.0
    elif cause:
        by = LOST * weights.against if cause == SensorFault.SILENT else weights.against
    watch.nats = weigh(watch.nats, by, weights.threshold)
    if watch.nats >= weights.threshold:
        watch.fault, watch.nats = int(cause), 0.0


def readmit(watch: Watch, fits: bool | None, weights: EvidenceWeights) -> None:
    """Judge an isolated sensor, whose sample fits or does not; None: nothing shows which."""
    if fits is None:
        return
    watch.nats = weigh(watch.nats, weights.fits if fits else weights.misfits, weights.threshold)
    if watch.nats >= weights.threshold:
        reset_watch(watch)


def reset_watch(watch: Watch) -> None:
    """Trust the sensor: no fault, and no evidence."""
    watch.fault, watch.nats = 0, 0.0
