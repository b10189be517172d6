"""The first estimate: from field and Sun in one tick, or from a batch of field and cells."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import final

import numpy as np

from fsw.core.algebra.vector import ZERO, Vec3, norm
from fsw.core.estimation import mekf
from fsw.core.estimation.cells.cell_set import CellSet, light
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.estimation.measurement import deflected_sun
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Parameters, component_places, with_component
from fsw.core.estimation.start.batch import MOST, SampleBatch, keep_sample, rest, search_due
from fsw.core.estimation.start.batch_model import BatchModel, model_of
from fsw.core.estimation.start.batch_sample import UNKNOWN, BatchSample
from fsw.core.estimation.start.search import PIECES, Stage, at_end, start_search, work
from fsw.core.estimation.start.triad import consistent, triad
from fsw.core.orbit.ephemeris import Reference


@final
@dataclass(frozen=True, slots=True)
class StartLimits:
    """Largest errors of field strength and field-Sun angle, and least separation of the two: T, rad, rad.

    ``albedo_error``: largest error of the albedo, by which the Earth's light turns the Sun's direction.
    """

    max_field_error_t: float
    max_angle_error_rad: float
    min_separation_rad: float
    albedo_error: float = 0.0


def first_estimate(
    field: Vec3 | None, sun: Vec3 | None, reference: Reference, limits: StartLimits, config: MekfConfig
) -> Estimate | None:
    """The estimate by TRIAD, if field and Sun are both there and consistent.

    Args:
        field: sample, T, body axes.
        sun: direction, body axes.
        reference: field and Sun as modelled.
        limits: what is accepted.
        config: the filter.
    """
    if field is None or sun is None or not reference.lit:
        return None
    b, (s, slope) = reference.b_eci_t, deflected_sun(config.initial_parameters, reference, config)
    angle_rad = limits.max_angle_error_rad + limits.albedo_error * norm(slope)
    if not consistent(field, sun, b, s, limits.max_field_error_t, angle_rad, limits.min_separation_rad):
        return None
    return mekf.start(triad(sun, field, s, b), ZERO, config)


def give_parameters(
    estimate: Estimate, given: Parameters | None, numbers: Sequence[int], config: MekfConfig
) -> None:
    """Set some components of the parameters to given values; the others stay as they were found.

    The error of each is then that of the prior, uncorrelated with the others.

    Args:
        estimate: holds the parameters.
        given: holds the values, SI units; None: there are none.
        numbers: of the components that are given.
        config: the filter.
    """
    if given is None or not numbers:
        return
    values, places = given.floats(), component_places(config.layout)
    covariance = estimate.covariance.copy()
    for number in numbers:
        estimate.parameters = with_component(estimate.parameters, number, values[number])
        if number in places:
            place = places[number]
            covariance[place, :] = covariance[:, place] = config.initial_covariance[place]
    estimate.covariance = covariance


def estimate_from_batch(
    batch: SampleBatch,
    field: Vec3 | None,
    currents: tuple[float | None, ...],
    reference: Reference,
    limits: StartLimits,
    config: MekfConfig,
) -> Estimate | None:
    """Add this tick's samples to a batch and do a tick's work on its search; the estimate if that ends it.

    Args:
        batch: of the ticks before.
        field: sample, T, body axes.
        currents: of the cells, fractions of full sunlight; None: not to be used.
        reference: field and Sun as modelled.
        limits: what is accepted of the field's strength.
        config: the filter.
    """
    cells = config.cells
    if cells is None:
        return None
    sample = _sample(field, currents, reference, limits, cells)
    if sample is not None:
        keep_sample(batch, sample)
    starts_now = search_due(batch)
    if batch.search is None and not starts_now:
        return None
    model = model_of(config, cells)
    if starts_now:
        batch.search, batch.searched_s = start_search(batch.samples, model), 0.0
    return _search(batch, sample is not None, reference, model)


def linear(estimate: Estimate, b_eci_t: Vec3, config: MekfConfig) -> bool:
    """Whether the attitude is known so well that the equations of the filter, which are linear, hold.

    An error theta of the attitude moves the field by |b| theta and, to second order, by |b| theta^2 / 2. The
    filter leaves the latter out, and begun too early it may lose the estimate. Here |b| theta^2 / 2 is to be
    less than the noise of a field sample, theta being the standard deviation about the worst axis.

    Args:
        estimate: by least squares over a batch, which are not bound to this.
        b_eci_t: field, T.
        config: the filter.

    Source: second-order terms as in Jazwinski 1970, chapter 9.
    """
    variance = float(np.linalg.eigvalsh(estimate.covariance[0:3, 0:3])[-1])
    return 0.5 * variance * norm(b_eci_t) <= sqrt(float(config.field_noise[0, 0]))


def _sample(
    field: Vec3 | None,
    currents: tuple[float | None, ...],
    reference: Reference,
    limits: StartLimits,
    cells: CellSet,
) -> BatchSample | None:
    """The sample of this tick, if field and cells are there and the field strength agrees with the model."""
    b = reference.b_eci_t
    if field is None or not currents or abs(norm(field) - norm(b)) > limits.max_field_error_t:
        return None
    seen = light(reference.r_eci_m, reference.sun_eci, cells.albedo)
    known = tuple([_known(cell, current, cells) for cell, current in enumerate(currents)])
    lit, earth = (0.0, 0.0) if seen is None else (1.0, seen.earth)
    coarse = None if seen is None else coarse_sun(currents, cells)
    return BatchSample(0.0, ZERO, field, known, b, reference.sun_eci, reference.r_eci_m, lit, earth, coarse)


def _known(cell: int, current: float | None, cells: CellSet) -> float:
    """The current of a cell as the search is to take it: in sunlight it knows no shades."""
    return UNKNOWN if current is None or cells.may_be_shaded(cell, current) else current


def _search(batch: SampleBatch, measured: bool, reference: Reference, model: BatchModel) -> Estimate | None:
    """Do a tick's pieces of the search; an estimate begins only in a tick with a sample.

    One that is not ``linear`` is left for a search over more samples, where there can be more.
    """
    since = rest(batch, reference.b_eci_t, reference.sun_eci, reference.r_eci_m)
    for _ in range(PIECES):
        search = batch.search
        if search is None or (at_end(search, batch.samples) and not measured):
            break
        estimate = work(search, batch.samples, since, model)
        if search.stage is Stage.ENDED:
            batch.search = None
        if estimate is not None:
            begins = search.searched >= MOST or linear(estimate, reference.b_eci_t, model.config)
            return estimate if begins else None
    return None
