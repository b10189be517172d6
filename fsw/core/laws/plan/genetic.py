"""The genetic search of PoSAT-1: the dipole with the least energy left, over the plane normal to the field.

A population of points of that plane; each generation keeps the best (elitism), takes in the null dipole again
(cloning: otherwise it may end at a dipole along the field, without torque), and is filled up with mixtures of
two parents, each the winner of a tournament of two, moved a little at random. The random numbers are a linear
congruential sequence from a seed: same seed, same result, on every machine.

Source: Tavares et al. (ConSat, PoSAT-1), after Goldberg 1989.
"""

from collections.abc import Iterator

from fsw.core.algebra.vector import ZERO, Mat3, Vec3, add, cross, dot, scale, sub, transform, unit

POPULATION = 24
GENERATIONS = 40
_SPREAD = 0.5
"""First spread of a move, relative to the size of the search."""
_NARROWING = 0.8705505632961241
"""Factor on the spread per generation: half after five. A number, since pow differs between machines."""

Point = tuple[float, float]


def search(
    impulse_body_nms: Vec3,
    b_body_t: Vec3,
    duration_s: float,
    most_am2: float,
    metric: Mat3,
    seed: int,
) -> Vec3:
    """The dipole normal to b that leaves the least of an impulse: min (r - dt m x b)^T W (r - dt m x b).

    Args:
        impulse_body_nms: r, body axes.
        b_body_t: field, body axes, not zero.
        duration_s: dt, for how long the dipole acts.
        most_am2: bound of its two components in the plane.
        metric: W, symmetric and positive; J^-1 for the kinetic energy.
        seed: of the random numbers.

    Returns:
        Dipole in body axes, A m^2; never worse than none.
    """
    first, second = _plane(b_body_t)
    random = _uniform(seed)

    def dipole(point: Point) -> Vec3:
        return add(scale(most_am2 * point[0], first), scale(most_am2 * point[1], second))

    def cost(point: Point) -> float:
        left = sub(impulse_body_nms, scale(duration_s, cross(dipole(point), b_body_t)))
        return dot(left, transform(metric, left))

    population = [(0.0, 0.0)] + [
        (2.0 * next(random) - 1.0, 2.0 * next(random) - 1.0) for _ in range(POPULATION - 1)
    ]
    ranked = sorted((cost(point), point) for point in population)
    spread = _SPREAD
    for _ in range(GENERATIONS):
        children = [_child(ranked, spread, random) for _ in range(POPULATION - 2)]
        spread *= _NARROWING
        elite = [ranked[0][1], (0.0, 0.0)]
        ranked = sorted((cost(point), point) for point in elite + children)
    best_cost, best = ranked[0]
    return dipole(best) if best_cost < cost((0.0, 0.0)) else ZERO


def _child(ranked: list[tuple[float, Point]], spread: float, random: Iterator[float]) -> Point:
    """A mixture of two parents, moved a little, within the bounds."""
    (x1, y1), (x2, y2) = _winner(ranked, random), _winner(ranked, random)
    share = next(random)
    x, y = share * x1 + (1.0 - share) * x2, share * y1 + (1.0 - share) * y2
    x, y = x + spread * (2.0 * next(random) - 1.0), y + spread * (2.0 * next(random) - 1.0)
    return (max(-1.0, min(1.0, x)), max(-1.0, min(1.0, y)))


def _winner(ranked: list[tuple[float, Point]], random: Iterator[float]) -> Point:
    """The better of two drawn from the ranked population."""
    return ranked[min(int(next(random) * len(ranked)), int(next(random) * len(ranked)))][1]


def _plane(b_body_t: Vec3) -> tuple[Vec3, Vec3]:
    """Two unit vectors normal to the field and to each other."""
    along = unit(b_body_t)
    axis = (1.0, 0.0, 0.0) if abs(along[0]) < 0.6 else (0.0, 1.0, 0.0)
    first = unit(cross(along, axis))
    return first, cross(along, first)


def _uniform(seed: int) -> Iterator[float]:
    """Numbers in [0, 1): x <- 6364136223846793005 x + 1442695040888963407 mod 2^64 (Knuth, MMIX)."""
    state = seed
    while True:
        state = (6364136223846793005 * state + 1442695040888963407) & 0xFFFF_FFFF_FFFF_FFFF
        yield (state >> 11) * 2.0**-53
