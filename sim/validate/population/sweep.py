"""Satellites of the 50 kg population in which one difference alone takes sizes up to twice its bound."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from fsw.input.schema import Nested, merge
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Order
from sim.campaign.population import POPULATIONS, is_rigid, nominal_scenario, satellite
from sim.value_types import Array

KIND, ORBITS = "50kg", 8.0
LIMITS = POPULATIONS[KIND].tolerances
LEAST_DIPOLE_AM2, BOUND_DIPOLE_AM2 = LIMITS.residual_dipole_am2
BOUND_TURNS_DEG = LIMITS.magnetometer_misalignment_deg + LIMITS.sun_misalignment_deg
TWICE = 2.0


@dataclass(frozen=True, slots=True)
class Quantity:
    """What a sweep varies.

    Attributes:
        name: short.
        label: with its unit.
        scale: ``log`` or ``linear``.
        least: size at which the sweep begins; it ends at twice the bound.
        bound: size that the onboard table declares.
        laid_over: what makes it so large in a satellite; by its seed, what is drawn of it, and the size.
    """

    name: str
    label: str
    scale: str
    least: float
    bound: float
    laid_over: Callable[[int, Nested, float], Nested]

    def sizes(self, count: int) -> tuple[float, ...]:
        """So many sizes, evenly spaced on the scale."""
        space = np.geomspace if self.scale == "log" else np.linspace
        return tuple(space(self.least, TWICE * self.bound, count).tolist())


def sweep_order(quantity: Quantity, size: float, seed: int) -> Order:
    """The flight of a satellite of the population in which that quantity has that size."""
    drawn = satellite(KIND, seed)
    overrides = merge(drawn, quantity.laid_over(seed, drawn, size))
    name = f"satellite {seed} of {KIND}, {quantity.name} {size:.3g}"
    return Order(POPULATIONS[KIND].scenario, overrides, seed, ORBITS, consistency_figures, name)


def _dipole(seed: int, drawn: Nested, size_am2: float) -> Nested:
    """Direction, and the part that points elsewhere in shadow, as drawn."""
    disturbance = drawn["disturbance"]
    factor = size_am2 / np.linalg.norm(disturbance["residual_dipole_am2"])
    keys = ("residual_dipole_am2", "residual_dipole_eclipse_am2")
    return {"disturbance": {key: (factor * np.array(disturbance[key])).tolist() for key in keys}}


def _inertia(seed: int, drawn: Nested, size_percent: float) -> Nested:
    """Errors of one shape at every size; the largest of a moment has that size.

    The products are to their bound as the moments to theirs. A rigid body can have the tensor at the largest
    size, and so at all others: the condition is convex.
    """
    nominal = np.array(nominal_scenario(POPULATIONS[KIND].scenario).body.inertia)
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=tuple(b"sweep")))
    diagonal, products = np.diagonal(nominal), LIMITS.products_percent / LIMITS.inertia_percent
    while True:
        parts, upper = random.uniform(-1.0, 1.0, 3), np.zeros((3, 3))
        upper[np.triu_indices(3, 1)] = products * diagonal.mean() * random.uniform(-1.0, 1.0, 3)
        error = np.diag(diagonal * parts / np.abs(parts).max()) + upper + upper.T
        if is_rigid(nominal + 0.01 * TWICE * LIMITS.inertia_percent * error):
            return {"body": {"inertia_kgm2": (nominal + 0.01 * size_percent * error).tolist()}}


def _turns(seed: int, drawn: Nested, size_deg: float) -> Nested:
    """Axes as drawn; both turns the same part of their bounds."""
    part, sensors = size_deg / BOUND_TURNS_DEG, drawn["sensors"]
    bounds = {"magnetometer": LIMITS.magnetometer_misalignment_deg, "sun": LIMITS.sun_misalignment_deg}
    return {
        "sensors": {
            name: {"misalignment_deg": (part * bound * _unit(sensors[name]["misalignment_deg"])).tolist()}
            for name, bound in bounds.items()
        }
    }


def _unit(vector: Sequence[float]) -> Array:
    unit: Array = np.array(vector) / np.linalg.norm(vector)
    return unit


QUANTITIES = (
    Quantity("dipole", "residual dipole [A m²]", "log", LEAST_DIPOLE_AM2, BOUND_DIPOLE_AM2, _dipole),
    Quantity("inertia", "largest error of a moment [%]", "linear", 0.0, LIMITS.inertia_percent, _inertia),
    Quantity("turns", "turns of both sensors, sum [deg]", "linear", 0.0, BOUND_TURNS_DEG, _turns),
)
