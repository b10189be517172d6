"""The watch over one unit: evidence against it while it is in use, and for it while it is isolated."""

from typing import NamedTuple

from fsw.core.fdir.evidence import EvidenceWeights, weigh
from fsw.core.fdir.faults import SensorFault

LOST = 0.5
"""Fraction of its weight that a missing sample has: the bus may lose some, in bursts."""


class Watch(NamedTuple):
    """One sensor: its fault (0: none), and the evidence against it; while it is isolated, for it; nats."""

    fault: int = 0
    nats: float = 0.0


def accused(watch: Watch, cause: int, unclear: bool, weights: EvidenceWeights) -> Watch:
    """A sensor in use after a tick: ``cause`` speaks against it, 0: nothing does; or it is unclear what."""
    by = -weights.against
    if unclear:
        by = 0.0
    elif cause:
        by = LOST * weights.against if cause == SensorFault.SILENT else weights.against
    nats = weigh(watch.nats, by, weights.threshold)
    if nats >= weights.threshold:
        return Watch(cause)
    return watch if nats == watch.nats else Watch(0, nats)


def readmitted(watch: Watch, fits: bool | None, weights: EvidenceWeights) -> Watch:
    """An isolated sensor after a tick in which its sample fits or does not; None: nothing shows which."""
    if fits is None:
        return watch
    nats = weigh(watch.nats, weights.fits if fits else weights.misfits, weights.threshold)
    return Watch() if nats >= weights.threshold else Watch(watch.fault, nats)
