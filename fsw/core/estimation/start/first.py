"""The first estimate: from field and Sun in one tick, or from a batch of field and cells."""

from typing import NamedTuple

from fsw.core.algebra.vector import ZERO, Vec3, norm
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.start.batch import UNKNOWN, BatchSample, SampleBatch, due, kept
from fsw.core.estimation.start.batch_fit import fitted
from fsw.core.estimation.start.triad import consistent, triad
from fsw.core.orbit.ephemeris import Reference


class StartLimits(NamedTuple):
    """How far field and Sun may be from the modelled ones, and how near to each other: T, rad, rad."""

    max_field_error_t: float
    max_angle_error_rad: float
    min_separation_rad: float


def first_estimate(
    field: Vec3 | None, sun: Vec3 | None, reference: Reference, limits: StartLimits, config: MekfConfig
) -> Estimate | None:
    """By TRIAD, where both are there and fit together.

    Args:
        field: sample, T, body axes.
        sun: direction, body axes.
        reference: field and Sun as modelled.
        limits: what is accepted.
        config: the filter.
    """
    if field is None or sun is None or not reference.lit:
        return None
    b, s = reference.b_eci_t, reference.sun_eci
    if not consistent(field, sun, b, s, *limits):
        return None
    return mekf.start(triad(sun, field, s, b), ZERO, config)


def from_batch(
    batch: SampleBatch,
    field: Vec3 | None,
    currents: tuple[float | None, ...],
    reference: Reference,
    limits: StartLimits,
    config: MekfConfig,
) -> tuple[SampleBatch, Estimate | None]:
    """The batch with the samples of this tick, and the estimate if its motion is found.

    Args:
        batch: of the ticks before.
        field: sample, T, body axes.
        currents: of the cells, parts of full sunlight; None: not to be used.
        reference: field and Sun as modelled.
        limits: what is accepted of the field's strength.
        config: the filter.
    """
    cells, b = config.cells, reference.b_eci_t
    if cells is None or field is None or not currents:
        return batch, None
    if abs(norm(field) - norm(b)) > limits.max_field_error_t:
        return batch, None
    seen = light(reference.r_eci_m, reference.sun_eci, cells.albedo)
    known = tuple([UNKNOWN if current is None else current for current in currents])
    lit, earth = (0.0, 0.0) if seen is None else (1.0, seen.earth)
    coarse = None if seen is None else coarse_sun(currents, cells)
    sample = BatchSample(0.0, ZERO, field, known, b, reference.sun_eci, reference.r_eci_m, lit, earth, coarse)
    batch = kept(batch, sample)
    if not due(batch):
        return batch, None
    return batch._replace(searched_s=0.0), fitted(batch.samples, config)
