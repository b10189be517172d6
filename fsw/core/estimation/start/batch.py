"""The start from Sun cells: the samples that field and cells give over minutes.

Three lit cells and the field give an attitude, some 10 deg off, and no rate: a filter started there would
diverge, so the samples of ``SHORT_S`` are fitted together. One or two lit cells leave the rotation about the
field open; the motion over ``LEAST_S`` determines it. A sample is kept every ``SPACING_S``, with the dipole
driven since the one before; ``search`` looks for the motion behind them, in pieces over the ticks.
"""

from dataclasses import dataclass, replace
from typing import final

from fsw.core.algebra.vector import ZERO, Vec3, add, scale
from fsw.core.estimation.start.batch_sample import BatchSample
from fsw.core.estimation.start.search import MotionSearch

SPACING_S = 20.0
SHORT_S, LEAST_S, MOST_S = 100.0, 400.0, 1200.0
"""The motion is searched for after the first if three cells are lit all the time, otherwise after the second,
and over the third at most."""
MOST = round(MOST_S / SPACING_S)
"""The same in samples."""
AGAIN_S = 100.0
"""Time until it is searched for again."""
GAP_S = 60.0
"""After a longer time without a sample the batch begins anew."""
ROUNDING_S = 1e-6
"""More than a sum of ticks is off by that are no binary fractions, 0.1 s for one."""


@final
@dataclass(slots=True)
class SampleBatch:
    """The samples, oldest first; time and impulse driven, A m^2 s, since the last.

    ``search`` is the one that is under way, and ``searched_s`` the time since the last one began.
    """

    samples: tuple[BatchSample, ...] = ()
    since_s: float = 0.0
    driven_am2s: Vec3 = ZERO
    searched_s: float = 0.0
    search: MotionSearch | None = None

    def copy(self) -> "SampleBatch":
        """A batch with the same samples, whose search goes on by itself."""
        search = None if self.search is None else self.search.copy()
        return SampleBatch(self.samples, self.since_s, self.driven_am2s, self.searched_s, search)

    @property
    def span_s(self) -> float:
        """From the first sample to the last."""
        return sum([sample.since_s for sample in self.samples[1:]], 0.0)

    @property
    def lit(self) -> int:
        """How many samples are in sunlight; a cell that is dark there shows where the Sun is not."""
        return sum([1 for sample in self.samples if sample.lit])


def discard_samples(batch: SampleBatch) -> None:
    """Begin anew, without a sample."""
    batch.samples, batch.search = (), None
    batch.since_s, batch.driven_am2s, batch.searched_s = 0.0, ZERO, 0.0


def pass_tick(batch: SampleBatch, m_body_am2: Vec3, tick_s: float) -> None:
    """Let a tick pass, over which this dipole was driven; after too long a gap discard the samples."""
    if not batch.samples:
        return
    batch.since_s += tick_s
    batch.searched_s += tick_s
    batch.driven_am2s = add(batch.driven_am2s, scale(tick_s, m_body_am2))
    if batch.since_s > GAP_S + ROUNDING_S:
        discard_samples(batch)


def keep_sample(batch: SampleBatch, sample: BatchSample) -> None:
    """Keep a sample, if one is due."""
    if batch.samples and batch.since_s < SPACING_S - ROUNDING_S:
        return
    if batch.samples:
        mean = scale(1.0 / batch.since_s, batch.driven_am2s)
        sample = replace(sample, since_s=batch.since_s, m_body_am2=mean)
    samples = (*batch.samples, sample)
    if batch.search is None:  # a search counts the samples from the first
        samples = samples[-MOST:]
    batch.samples, batch.since_s, batch.driven_am2s = samples, 0.0, ZERO


def rest(batch: SampleBatch, b_eci_t: Vec3, s_eci: Vec3, r_eci_m: Vec3) -> BatchSample | None:
    """What was driven from the last sample to this tick, as a sample without measurements."""
    if not batch.since_s:
        return None
    mean = scale(1.0 / batch.since_s, batch.driven_am2s)
    return BatchSample(batch.since_s, mean, ZERO, (), b_eci_t, s_eci, r_eci_m, 0.0, 0.0)


def search_due(batch: SampleBatch) -> bool:
    """Whether a search for the motion is to begin, with the sample just kept."""
    if (
        batch.search is not None
        or batch.since_s
        or not batch.samples
        or batch.searched_s < min(AGAIN_S, batch.span_s) - ROUNDING_S
    ):
        return False
    coarse = all([sample.coarse for sample in batch.samples])
    enough = batch.span_s >= (SHORT_S if coarse else LEAST_S) - ROUNDING_S
    return enough and 2 * batch.lit >= len(batch.samples)
