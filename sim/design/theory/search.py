"""The best gains: the least degree of stability over the map (k_w, k_a), and over k_i.

The degree is smooth in the gains except at kinks, where multipliers meet; the optima lie on kinks, and near
one the degree rises as the square root of the distance. A grid over the logarithms of the gains finds the
basins; the simplex method of Nelder and Mead, restarted with smaller and smaller simplices, descends in each.
Nothing is random. As no gains are realised to the last digit, the steady gains are sought too: those whose
greatest degree within ``MARGIN`` of both is least. Gains stabilise a body only if that is negative: a body
that the gravity gradient turns over can have stable gains on a strip too thin for any model of the field.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.floquet import NEUTRAL, STEPS, degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.value_types import Array

Degree = Callable[[Gains], Array]
"""Degrees of stability, of the shape of the gains."""
Watch = Callable[[int], None]
Bounds = tuple[float | None, float | None]

MARGIN = 0.1
"""Relative error of the gains at which they must still stabilise; of the field's strength, half as much."""

GRID = 40
SPAN_W = (0.03, 100.0)
SPAN_A = (0.003, 300.0)
"""Gains are sought between these multiples of the natural ones."""
SPAN_I = (1e-4, 10.0)

STARTS = 4
"""Basins of the grid in which a minimum is sought."""
WIDE, NARROW, FLAT = (0.2, 0.03), (0.03, 0.004, 0.0005), (0.1, 0.02)
"""Sizes of simplices, in logarithms of the gains: in a basin, at its kink, and in its flat part."""
SEARCH_STEPS = GRID + STARTS + 1 + STARTS
"""The steps that ``search`` reports to ``watch``."""

_AROUND = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)])


@dataclass(frozen=True, slots=True)
class GainMap:
    """Degrees of stability over a grid: ``degree[i, j]`` at ``k_a[i]``, ``k_w[j]``."""

    k_w: Array
    k_a: Array
    degree: Array


@dataclass(frozen=True, slots=True)
class Candidate:
    """Gains with their degree of stability.

    Attributes:
        gains: the gains.
        degree: their degree of stability.
        worst_degree: the greatest degree within ``MARGIN`` of both gains.
    """

    gains: Gains
    degree: float
    worst_degree: float


@dataclass(frozen=True, slots=True)
class Search:
    """The result of a search.

    Attributes:
        map: the grid it started from.
        best: the gains of the least degree.
        steady: the gains of the least worst degree.
    """

    map: GainMap
    best: Candidate
    steady: Candidate

    @property
    def stabilised(self) -> bool:
        """Whether there are gains that stabilise even when they are off by ``MARGIN``."""
        return self.steady.worst_degree < -NEUTRAL


def continuous(body: Body, steps: int = STEPS) -> Degree:
    """The degree of stability of a body under a continuous dipole."""
    return lambda gains: degree_of_stability(monodromy(closed_loop(body, gains), steps))


def natural_gains(body: Body) -> Gains:
    """J w0 / B0^2, J w0^2 / (2 B0^2), J w0^3 / (2 B0^2) with J the mean moment."""
    mean, w0, b0 = float(np.trace(np.asarray(body.inertia_kgm2))) / 3.0, body.rate_radps, body.field_t
    return Gains(mean * w0 / b0**2, 0.5 * mean * w0**2 / b0**2, 0.5 * mean * w0**3 / b0**2)


def gain_map(body: Body, degree: Degree, watch: Watch = lambda done: None) -> GainMap:
    """Degrees over the whole span of gains; ``watch`` is called with the number of rows done, of ``GRID``."""
    natural = natural_gains(body)
    k_w, k_a = natural.k_w * np.geomspace(*SPAN_W, GRID), natural.k_a * np.geomspace(*SPAN_A, GRID)
    rows = []
    for done, gain in enumerate(k_a, start=1):
        rows.append(degree(Gains(k_w, np.full_like(k_w, gain))))
        watch(done)
    return GainMap(k_w, k_a, np.array(rows))


def search(body: Body, fine: Degree, rough: Degree, watch: Watch = lambda done: None) -> Search:
    """The best and the steady gains.

    Args:
        body: for the scale of its gains.
        fine: degree of stability by which gains are judged.
        rough: the same, less exact, for the grid and the descents.
        watch: called with the number of steps done, of ``SEARCH_STEPS``.
    """
    grid = gain_map(body, rough, watch)
    bounds = [(np.log(gains[0]), np.log(gains[-1])) for gains in (grid.k_w, grid.k_a)]
    lows: list[Array] = []
    for done, start in enumerate(_basins(grid), start=1):
        lows.append(_descend(rough, start, WIDE, bounds))
        watch(GRID + done)
    best = _descend(fine, min(lows, key=lambda low: _at(rough, low)), NARROW, bounds)
    watch(GRID + STARTS + 1)
    worst = _worst_within_margin(rough)
    flats: list[Array] = []
    for done, low in enumerate(_apart(lows), start=1):
        flats.append(_descend(worst, low, FLAT, bounds))
        watch(GRID + STARTS + 1 + done)
    steady = min(flats, key=lambda flat: _at(worst, flat))
    watch(SEARCH_STEPS)
    return Search(grid, candidate(fine, Gains(*np.exp(best))), candidate(fine, Gains(*np.exp(steady))))


def candidate(degree: Degree, gains: Gains) -> Candidate:
    """Gains with their degrees."""
    chosen = Gains(float(gains.k_w), float(gains.k_a), gains.k_i)
    return Candidate(chosen, float(degree(chosen)), float(_worst_within_margin(degree)(chosen)))


def best_integral(body: Body, gains: Gains, degree: Degree) -> Gains:
    """The same gains with the k_i [N m / (T^2 s)] of the least degree of stability of the nine states.

    Args:
        body: for the scale of k_i.
        gains: k_w and k_a, which stay.
        degree: degree of stability of nine states.
    """
    low, high = SPAN_I
    natural = np.asarray(natural_gains(body).k_i)
    for _ in range(3):
        k_i = natural * np.geomspace(low, high, GRID)
        place = int(degree(Gains(np.full_like(k_i, gains.k_w), np.full_like(k_i, gains.k_a), k_i)).argmin())
        best = float(k_i[place])
        low, high = (float(k_i[min(max(place + to, 0), GRID - 1)] / natural) for to in (-1, 1))
    return Gains(gains.k_w, gains.k_a, best)


def _worst_within_margin(degree: Degree) -> Degree:
    """The greatest degree among the gains themselves and both off by ``MARGIN``, up or down."""

    def greatest(gains: Gains) -> Array:
        off_w, off_a = np.exp(MARGIN * _AROUND).T
        k_w, k_a = np.asarray(gains.k_w)[..., None], np.asarray(gains.k_a)[..., None]
        k_i = None if gains.k_i is None else np.asarray(gains.k_i)[..., None]
        worst: Array = degree(Gains(k_w * off_w, k_a * off_a, k_i)).max(axis=-1)
        return worst

    return greatest


def _basins(grid: GainMap) -> list[Array]:
    """Logarithms (k_w, k_a) of the grid's local minima, the lowest first."""
    degree, rows, columns = grid.degree, *grid.degree.shape
    walled = np.pad(degree, 1, constant_values=np.inf)
    windows = [walled[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    places = np.argwhere(degree <= np.min(windows, axis=0))
    lowest = sorted(map(tuple, places), key=lambda place: degree[place])[:STARTS]
    return [np.log([grid.k_w[j], grid.k_a[i]]) for i, j in lowest]


def _apart(places: list[Array]) -> list[Array]:
    """Places without those within a tenth of one before them."""
    distinct: list[Array] = []
    for place in places:
        if all(np.abs(place - other).max() > 0.1 for other in distinct):
            distinct.append(place)
    return distinct


def _descend(degree: Degree, start: Array, simplices: tuple[float, ...], bounds: Sequence[Bounds]) -> Array:
    """Logarithms (k_w, k_a) of a local minimum."""
    from scipy.optimize import minimize  # noqa: PLC0415  (slow to load)

    place = start
    for size in simplices:
        simplex = place + size * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        found = minimize(
            partial(_at, degree),
            place,
            method="Nelder-Mead",
            bounds=bounds,
            options={"initial_simplex": simplex, "xatol": 1e-3 * size, "fatol": 1e-8, "maxiter": 80},
        )
        place = np.asarray(found.x, dtype=np.float64)
    return place


def _at(degree: Degree, logs: Array) -> float:
    return float(degree(Gains(*np.exp(logs))))
