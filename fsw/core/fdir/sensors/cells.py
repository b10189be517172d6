"""Which Sun cell is faulty: dead, stuck, or with a current that nothing allowed by the table explains.

Each cell is compared with what the estimate predicts, while the estimate is proven and the field has been
taken with it. What speaks against a cell:

- it gives a current in the Earth's shadow, more often than none;
- it is lit, and the filter refuses what it shows, or it shows nothing;
- its gain, or what it shows beyond its model, exceeds ``SIGMAS`` of the standard deviations that the table
  allows;
- it faces away from the Sun, and is brighter than that excess and the Earth, as all cells show it, allow;
- its current does not change by one bit while the predicted one moves by ``STILL``, and by a step of its own
  if it has one.

A cell that is still is not used from the next tick on, whatever the evidence.

What the filter has learnt of a cell is forgotten when it is isolated: nothing more is learnt of it meanwhile,
so that it is compared with the table and may come back. One comes back too while no single sample shows that
its gain is wrong, until the filter has learnt it again.

Two cells are not taken to fail under one estimate, but a wrong estimate is contradicted by one cell after
another as the satellite turns. What speaks against a second cell that is lit speaks against the estimate.

An attitude that is uncertain is wrong more often than a cell: the cosine of its angle to the Sun is what the
estimate has it, give or take ``SIGMAS`` standard deviations. Where these reach an edge of what the cell sees,
or exceed what linear equations hold for, nothing is compared. Of an estimate that was once too uncertain for
these, and has not been proven since, what speaks against a cell speaks against the estimate alone.
"""

from dataclasses import dataclass, field, replace
from math import sqrt
from typing import Final, final

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import cross, dot
from fsw.core.estimation.cells.cell_set import CellSet, Light
from fsw.core.estimation.cells.prediction import LEAST_COSINE, most_behind, prediction
from fsw.core.estimation.cells.update import CellsUsed, take_cell
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.loaded import forget
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import COMPONENTS, Parameters, component_places
from fsw.core.fdir.evidence import SIGMAS, EvidenceWeights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.cell_evidence import CellEvidence
from fsw.core.fdir.sensors.certainty import across_variance, is_linear_cosine, turn_variance
from fsw.core.fdir.sensors.watch import Watch, accuse, readmit

STILL: Final = 0.06
"""Fraction of full sunlight by which a still current should have moved: eight steps of it on the bus."""
NO_CURRENT: Final = -1.0
GAIN_1, EXCESS_1 = (COMPONENTS.index((name, 0)) for name in ("cell_gain", "cell_excess"))
"""Numbers of these components of the first cell; those of the others follow."""


@final
@dataclass(slots=True)
class CellWatch:
    """One cell: the evidence, its current since the last change of it, and what was predicted then.

    ``still``: the prediction has moved since, and the current has not. ``by_this``: it is isolated because of
    what the estimate in use predicts for it in the light.
    """

    watch: Watch = field(default_factory=Watch)
    current: float = NO_CURRENT
    predicted: float = 0.0
    still: bool = False
    by_this: bool = False


CellsHealth = list[CellWatch]
"""By cell; empty before the first evidence, and without cells."""


def judge_cells(
    health: CellsHealth, evidence: CellEvidence, weights: EvidenceWeights, config: MekfConfig
) -> None:
    """Judge the cells by a tick; there are none where the satellite has none."""
    cells, currents = config.cells, evidence.currents
    if evidence.new:  # with the board silent, too
        for one in health:
            one.by_this = False
    if cells is None or not currents:
        return
    if not health:
        health.extend([CellWatch() for _ in cells.normals_body])
    for cell in range(len(health)):
        current = currents[cell]
        if current is not None:
            _judge_cell(health[cell], cell, current, evidence, weights, config, cells)


def is_contradicted(health: CellsHealth) -> bool:
    """Whether the estimate in use has had more than one cell isolated."""
    isolated = 0
    for one in health:
        if one.by_this:
            isolated += 1
    return isolated > 1


def is_doubtful(health: CellsHealth, weights: EvidenceWeights) -> bool:
    """Whether it has had one isolated, and over half of what isolates a cell speaks against another."""
    accused = isolated = False
    for one in health:
        accused = accused or (one.watch.nats > 0.5 * weights.threshold and not one.watch.fault)
        isolated = isolated or one.by_this
    return accused and isolated


def disproves(health: CellsHealth, weights: EvidenceWeights) -> bool:
    """Whether half of what isolates a cell speaks against one in use: of an estimate on trial, against it."""
    accused = False
    for one in health:
        accused = accused or (one.watch.nats > 0.5 * weights.threshold and not one.watch.fault)
    return accused


def forget_accusations(health: CellsHealth) -> None:
    """Forget what speaks against cells in use: it was shown by an attitude that is no longer relied on."""
    for one in health:
        if not one.watch.fault:
            one.watch.nats = 0.0


def unusable_cells(health: CellsHealth) -> tuple[int, ...]:
    """Numbers of the cells that the filter is not to take."""
    return tuple([cell for cell, one in enumerate(health) if one.watch.fault or one.still])


def isolated_cells(health: CellsHealth) -> tuple[int, ...]:
    """Numbers of the cells that are isolated."""
    return tuple([cell for cell, one in enumerate(health) if one.watch.fault])


def cell_faults(health: CellsHealth) -> tuple[int, ...]:
    """The fault of each cell; empty before the first evidence."""
    return tuple([one.watch.fault for one in health])


def cell_changes(before: tuple[int, ...], after: tuple[int, ...]) -> list[tuple[int, int, int]]:
    """(number, fault before, fault after) of each cell whose fault has changed; without a watch, none."""
    found = []
    for cell in range(max(len(before), len(after))):
        was = before[cell] if before else 0
        now = after[cell] if after else 0
        if was != now:
            found.append((cell, was, now))
    return found


def forget_isolated(
    state: EstimatorState, before: tuple[int, ...], health: CellsHealth, config: MekfConfig
) -> None:
    """Forget gain and excess of the cells isolated in this tick; not while the parameters are frozen.

    Args:
        state: of the estimator.
        before: the faults of the tick before.
        health: of this tick.
        config: of the filter.
    """
    for cell, _, fault in cell_changes(before, cell_faults(health)):
        for number in (GAIN_1 + cell, EXCESS_1 + cell):
            if fault and number in component_places(config.layout) and not state.frozen:
                forget(state, number, config)


def _judge_cell(
    one: CellWatch,
    cell: int,
    current: float,
    evidence: CellEvidence,
    weights: EvidenceWeights,
    config: MekfConfig,
    cells: CellSet,
) -> None:
    """Judge a cell by a tick, and whether it is isolated because of the estimate in use."""
    was_isolated = one.watch.fault != 0
    if evidence.light is None:
        _forget_current(one)
        if evidence.shadow:
            _weigh(one.watch, _by_dark(one.watch.fault, current, cells), False, weights)
    elif evidence.estimate is not None and (evidence.sure or (evidence.on_trial and not was_isolated)):
        _compare(one, cell, current, evidence.estimate, evidence.light, evidence.used, weights, config, cells)
    if not was_isolated:
        one.by_this = evidence.light is not None
    one.by_this = one.by_this and one.watch.fault != 0


def _compare(
    one: CellWatch,
    cell: int,
    current: float,
    estimate: Estimate,
    light: Light,
    used: CellsUsed,
    weights: EvidenceWeights,
    config: MekfConfig,
    cells: CellSet,
) -> None:
    """Compare a cell with what an estimate that is proven predicts for it."""
    normal = cells.normals_body[cell]
    s = rotate(estimate.q_body_from_eci, light.s_eci)
    if cells.shaded(cell, s, SIGMAS * sqrt(across_variance(estimate, s))):
        _forget_current(one)
        return
    cosine, spread = dot(normal, s), SIGMAS * sqrt(turn_variance(estimate, cross(normal, s)))
    if cosine <= LEAST_COSINE:
        _forget_current(one)
        e = rotate(estimate.q_body_from_eci, light.e_eci)
        within = SIGMAS * sqrt(turn_variance(estimate, cross(normal, e)))
        behind = cosine < -max(LEAST_COSINE, spread)
        if behind and current > most_behind(estimate, normal, light, cells, within):
            _weigh(one.watch, SensorFault.STRENGTH, False, weights)
        return
    _, row = prediction(estimate, cell, light, config, cells)
    if cosine - spread <= cells.dark or not is_linear_cosine(estimate, cosine, s, row, cells.sigma):
        _forget_current(one)
        return
    predicted, _ = prediction(_as_by_table(estimate), cell, light, config, cells)
    if current != one.current:
        one.current, one.predicted = current, predicted
    one.still = abs(predicted - one.predicted) > STILL + cells.step
    unclear = len(used.refused) > max(1, len(used.taken))
    verdict = _verdict(one, cell, current, used, estimate, cells)
    if verdict is None and one.watch.fault and not used.refused:
        fits = take_cell(estimate.copy(), cell, current, light, config, cells)
        verdict = 0 if fits else SensorFault.REFUSED
    _weigh(one.watch, verdict, unclear, weights)


def _forget_current(one: CellWatch) -> None:
    """Begin anew to compare how current and prediction move."""
    one.current, one.predicted, one.still = NO_CURRENT, 0.0, False


def _by_dark(fault: int, current: float, cells: CellSet) -> int | None:
    """What the shadow shows of a cell: that it is a lamp, or none; nothing of a cell with another fault."""
    if current > cells.dark:
        return SensorFault.UNLIT
    return 0 if fault in (0, SensorFault.UNLIT) else None


def _as_by_table(estimate: Estimate) -> Estimate:
    """The estimate with gains and albedo as in the table: a stuck cell draws its own gain after it."""
    return replace(estimate, parameters=replace(estimate.parameters, cell_gain=(), earth_light=()))


def _verdict(
    one: CellWatch, cell: int, current: float, used: CellsUsed, estimate: Estimate, cells: CellSet
) -> int | None:
    """What speaks against a lit cell; 0: it is as predicted, None: the filter neither took nor refused it."""
    if one.still:
        return SensorFault.FROZEN
    if current <= cells.dark or _is_beyond(estimate.parameters, cell, cells):
        return SensorFault.STRENGTH
    if cell in used.refused:
        return SensorFault.REFUSED
    return 0 if cell in used.taken else None


def _is_beyond(parameters: Parameters, cell: int, cells: CellSet) -> bool:
    """Whether excess or gain of a cell is beyond what the table allows."""
    gain = parameters.cell_gain[cell] if parameters.cell_gain else 0.0
    excess = parameters.cell_excess[cell]
    return abs(excess) > SIGMAS * cells.excess_sigma or abs(gain) > SIGMAS * cells.gain_sigma


def _weigh(watch: Watch, verdict: int | None, unclear: bool, weights: EvidenceWeights) -> None:
    """Accuse a cell in use, or readmit an isolated one; without a comparison nothing changes."""
    if verdict is None:
        return
    if watch.fault:
        readmit(watch, not verdict, weights)
    else:
        accuse(watch, verdict, unclear, weights)
