"""Orbit and field of a flight: what the law expects at each step, and what acts at each half step."""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from fsw.core.algebra.vector import scale
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import EphemerisModel, Reference, advance, reference_at
from sim.plant.environment.surroundings import Surroundings

NODES_HZ = 2
"""The ticks of the ephemeris: an instant within a step is a whole number of them."""


class Path(NamedTuple):
    """References a step, surroundings a half step with that at the end."""

    references: tuple[Reference, ...]
    around: tuple[Surroundings, ...]


def path_of(model: EphemerisModel, key: str, step_s: float, steps: int) -> Path:
    """Orbit and field over so many steps, computed once for each orbit.

    Raises:
        ValueError: the orbit has no position.
    """
    return _path(_Keyed(key, model), step_s, steps)


class _Keyed:
    """An ephemeris that is the same as another one of the same key."""

    def __init__(self, key: str, model: EphemerisModel) -> None:
        self.key, self.model = key, model

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Keyed) and other.key == self.key


@lru_cache(maxsize=4)
def _path(keyed: _Keyed, step_s: float, steps: int) -> Path:
    given = keyed.model
    model = replace(given, tick_hz=NODES_HZ, node_ticks=given.node_ticks // given.tick_hz * NODES_HZ)
    half_ticks = round(0.5 * step_s * NODES_HZ)
    window, references, around = None, [], []
    for half in range(2 * steps + 1):
        tick = half * half_ticks
        window = advance(window, tick, model)
        if window is None:
            raise ValueError(f"the orbit has no position {tick / NODES_HZ:g} s after its epoch")
        reference = reference_at(window, tick, model)
        if half % 2 == 0:
            references.append(reference)
        gradient = 3.0 * MU_M3PS2 / reference.radius_m**3
        radius = scale(1.0 / reference.radius_m, reference.r_eci_m)
        around.append(Surroundings(radius, gradient, reference.b_eci_t))
    return Path(tuple(references[:-1]), tuple(around))
