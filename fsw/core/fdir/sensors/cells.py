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
"""

from collections.abc import Sequence
from typing import NamedTuple

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import dot
from fsw.core.estimation.cells.cell_set import CellSet, Light
from fsw.core.estimation.cells.prediction import LEAST_COSINE, most_behind, prediction
from fsw.core.estimation.cells.update import CellsUsed, taken
from fsw.core.estimation.estimator import EstimatorState
from fsw.core.estimation.loaded import forget
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import COMPONENTS, NAMES, Parameters, component_places
from fsw.core.fdir.evidence import SIGMAS, EvidenceWeights
from fsw.core.fdir.faults import SensorFault
from fsw.core.fdir.sensors.watch import Watch, accused, readmitted

STILL = 0.06
"""Fraction of full sunlight by which a still current should have moved: eight steps of it on the bus."""
NO_CURRENT = -1.0
GAIN_1, EXCESS_1 = (COMPONENTS.index((NAMES.index(name), 0)) for name in ("cell_gain", "cell_excess"))
"""Numbers of these components of the first cell; those of the others follow."""


class CellWatch(NamedTuple):
    """One cell: the evidence, what it has shown since its last change, and what was predicted then.

    ``still``: the prediction has moved since, and the current has not. ``by_this``: it is isolated because of
    what the estimate in use predicts for it in the light.
    """

    watch: Watch = Watch()
    shown: float = NO_CURRENT
    predicted: float = 0.0
    still: bool = False
    by_this: bool = False


CellsHealth = tuple[CellWatch, ...]


class CellEvidence(NamedTuple):
    """What one tick shows of all cells.

    ``currents`` are of isolated cells too; ``seen`` is None in the shadow, and ``shadow`` says that this is
    certain. ``sure``: the estimate is proven, and the field confirms it; ``begun``: there is none yet, or it
    began in this tick.
    """

    currents: Sequence[float | None]
    used: CellsUsed
    estimate: Estimate | None
    seen: Light | None
    shadow: bool
    sure: bool
    begun: bool


def judge(
    health: CellsHealth, evidence: CellEvidence, weights: EvidenceWeights, config: MekfConfig
) -> CellsHealth:
    """The cells after a tick; none where the satellite has none."""
    cells = config.cells
    if evidence.begun:  # with the board silent, too
        health = tuple([watch._replace(by_this=False) for watch in health])
    if cells is None or not evidence.currents:
        return health
    watches = health or (CellWatch(),) * len(cells.normals_body)
    return tuple(
        [
            _watched(watch, cell, current, evidence, weights, config, cells)
            for cell, (watch, current) in enumerate(zip(watches, evidence.currents, strict=True))
        ]
    )


def contradicted(health: CellsHealth) -> bool:
    """Whether the estimate in use has had more than one cell isolated."""
    return sum([one.by_this for one in health]) > 1


def doubtful(health: CellsHealth, weights: EvidenceWeights) -> bool:
    """Whether it has had one isolated, and over half of what isolates a cell speaks against another."""
    accused_too = any(one.watch.nats > 0.5 * weights.threshold and not one.watch.fault for one in health)
    return accused_too and any(one.by_this for one in health)


def unusable(health: CellsHealth) -> tuple[int, ...]:
    """Numbers of the cells that the filter is not to take."""
    return tuple([cell for cell, one in enumerate(health) if one.watch.fault or one.still])


def faulty(health: CellsHealth) -> tuple[int, ...]:
    """Numbers of the cells that are isolated."""
    return tuple([cell for cell, one in enumerate(health) if one.watch.fault])


def cell_changes(before: CellsHealth, after: CellsHealth) -> list[tuple[int, int, int]]:
    """(number, fault before, fault after) of each cell whose fault has changed; without a watch, none."""
    cells = max(len(before), len(after))
    was, now = (health or (CellWatch(),) * cells for health in (before, after))
    return [
        (cell, one.watch.fault, other.watch.fault)
        for cell, (one, other) in enumerate(zip(was, now, strict=True))
        if one.watch.fault != other.watch.fault
    ]


def without_isolated(
    state: EstimatorState, before: CellsHealth, after: CellsHealth, config: MekfConfig
) -> EstimatorState:
    """The state without gain and excess of the cells that have just been isolated; as it is while frozen."""
    places = component_places(config.layout)
    for cell, _, fault in cell_changes(before, after):
        for number in (GAIN_1 + cell, EXCESS_1 + cell):
            if fault and number in places and not state.frozen:
                state = forget(state, number, config)
    return state


def _watched(
    before: CellWatch,
    cell: int,
    current: float | None,
    evidence: CellEvidence,
    weights: EvidenceWeights,
    config: MekfConfig,
    cells: CellSet,
) -> CellWatch:
    """A cell after a tick, and whether it is isolated because of the estimate in use."""
    if current is None:
        return before
    after = _judged(before, cell, current, evidence, weights, config, cells)
    by_this = before.by_this if before.watch.fault else evidence.seen is not None
    return after._replace(by_this=by_this and bool(after.watch.fault))


def _judged(
    before: CellWatch,
    cell: int,
    current: float,
    evidence: CellEvidence,
    weights: EvidenceWeights,
    config: MekfConfig,
    cells: CellSet,
) -> CellWatch:
    if evidence.seen is None:
        verdict = _by_dark(before.watch.fault, current, cells) if evidence.shadow else None
        return CellWatch(_weighed(before.watch, verdict, False, weights))
    if evidence.estimate is None or not evidence.sure:
        return before
    estimate, seen, normal = evidence.estimate, evidence.seen, cells.normals_body[cell]
    s = rotate(estimate.q_body_from_eci, seen.s_eci)
    if cells.shaded(cell, s):
        return CellWatch(before.watch)
    if dot(normal, s) <= LEAST_COSINE:
        bright = dot(normal, s) < -LEAST_COSINE and current > most_behind(estimate, normal, seen, cells)
        return CellWatch(_weighed(before.watch, SensorFault.STRENGTH if bright else None, False, weights))
    predicted, _ = prediction(_as_by_table(estimate), cell, seen, config, cells)
    shown = before._replace(still=False)
    if current != before.shown:
        shown = CellWatch(before.watch, current, predicted)
    shown = shown._replace(still=abs(predicted - shown.predicted) > STILL + cells.step)
    unclear = len(evidence.used.refused) > max(1, len(evidence.used.taken))
    verdict = _verdict(shown, cell, current, evidence.used, estimate, cells)
    if verdict is None and before.watch.fault and not evidence.used.refused:
        fits = taken(estimate, cell, current, seen, config, cells) is not None
        verdict = 0 if fits else SensorFault.REFUSED
    return shown._replace(watch=_weighed(before.watch, verdict, unclear, weights))


def _by_dark(fault: int, current: float, cells: CellSet) -> int | None:
    """What the shadow shows of a cell: that it is a lamp, or none; nothing of a cell with another fault."""
    if current > cells.dark:
        return SensorFault.UNLIT
    return 0 if fault in (0, SensorFault.UNLIT) else None


def _as_by_table(estimate: Estimate) -> Estimate:
    """The estimate with gains and albedo as in the table: a stuck cell draws its own gain after it."""
    return estimate._replace(parameters=estimate.parameters._replace(cell_gain=(), earth_light=()))


def _verdict(
    shown: CellWatch,
    cell: int,
    current: float,
    used: CellsUsed,
    estimate: Estimate,
    cells: CellSet,
) -> int | None:
    """What speaks against a lit cell; 0: it is as predicted, None: the filter neither took nor refused it."""
    if shown.still:
        return SensorFault.FROZEN
    if current <= cells.dark or _beyond(estimate.parameters, cell, cells):
        return SensorFault.STRENGTH
    if cell in used.refused:
        return SensorFault.REFUSED
    return 0 if cell in used.taken else None


def _beyond(known: Parameters, cell: int, cells: CellSet) -> bool:
    """Whether excess or gain of a cell is beyond what the table allows."""
    gain = known.cell_gain[cell] if known.cell_gain else 0.0
    excess = known.cell_excess[cell]
    return abs(excess) > SIGMAS * cells.excess_sigma or abs(gain) > SIGMAS * cells.gain_sigma


def _weighed(watch: Watch, verdict: int | None, unclear: bool, weights: EvidenceWeights) -> Watch:
    """A cell in use may be accused, an isolated one readmitted; without a comparison nothing changes."""
    if verdict is None:
        return watch
    if watch.fault:
        return readmitted(watch, not verdict, weights)
    return accused(watch, verdict, unclear, weights)
