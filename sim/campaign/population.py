"""Populations of real satellites: what flies differs from its onboard table within bounds, at random.

A satellite depends on its kind and seed alone, so it is the same in a campaign as by itself. The plant gets
the true values; the onboard table keeps the nominal values of the scenario.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cache
from math import sqrt

import numpy as np

from fsw.input.schema import Nested, merge
from fsw.table.ordinary import mean_moment
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Order
from sim.scenario.schema import Scenario, load
from sim.value_types import Array

Interval = tuple[float, float]

START_DEG, START_DEGPS = 60.0, 0.05
"""Largest initial errors: of the angle, and of the rate about each body axis."""


@dataclass(frozen=True, slots=True)
class Tolerances:
    """By how much a satellite may differ from its table; uniform within that, except for the dipole.

    That of ``non_orthogonality_deg`` has no bound of its own on board: with it the magnetometer stays within
    that of its misalignment. The light of the Earth never exceeds its bound, which is near the most there is.

    Attributes:
        residual_dipole_am2: least and most, any direction; its logarithm is uniform.
        torque_nm: per body axis, at the peak of its daily variation.
        declared_torque_nm: what the table has to allow for: the same, and five times drag and light, which
            change along the orbit.
        inertia_percent: of each moment.
        products_percent: of inertia, of the mean principal moment.
        coil_gain_percent: of each coil.
        coil_misalignment_deg: of each coil's axis, the total angle.
        magnetometer_bias_nt: per axis.
        magnetometer_scale_percent: per axis.
        magnetometer_misalignment_deg: the total angle.
        sun_misalignment_deg: the total angle.
        along_track_km: by which the satellite is ahead of its elements, or behind them.
        latency_s: of both sensors; every satellite has it in full.
        non_orthogonality_deg: per pair of axes of the magnetometer.
        eclipse_dipole_percent: of the largest dipole, what the Earth's shadow adds to it at most.
        remanence_percent: of the dipole of a pulse, what its coil keeps.
        magnetometer_orbit_nt: amplitude per axis with which its bias follows the orbit, at any phase.
        magnetometer_shadow_nt: per axis, by which it changes in the shadow.
        storm_nt: of the field at high latitude.
        albedo_percent: of sunlight, what the Earth reflects onto the Sun sensor; it varies over the clouds.
        snap_radps: change of the rate per axis at the shadow's edge; the table allows for the ordinary one.
    """

    residual_dipole_am2: Interval
    torque_nm: float
    declared_torque_nm: float
    inertia_percent: float = 10.0
    products_percent: float = 2.0
    coil_gain_percent: float = 5.0
    coil_misalignment_deg: float = 0.5
    magnetometer_bias_nt: float = 1000.0
    magnetometer_scale_percent: float = 0.5
    magnetometer_misalignment_deg: float = 1.0
    sun_misalignment_deg: float = 0.5
    along_track_km: float = 5.0
    latency_s: float = 1.0
    non_orthogonality_deg: float = 0.1
    eclipse_dipole_percent: float = 7.0
    remanence_percent: float = 0.3
    magnetometer_orbit_nt: float = 250.0
    magnetometer_shadow_nt: float = 400.0
    storm_nt: float = 150.0
    albedo_percent: float = 60.0
    snap_radps: float = 1.5e-5

    def declared(self) -> Nested:
        """The bounds, of the shadow's edge the ordinary ones, as ``[uncertainty]`` of an onboard table."""
        values = {key: value for key, value in asdict(self).items() if key not in NOT_DECLARED}
        values["residual_dipole_am2"] = self.residual_dipole_am2[1]
        values["torque_nm"] = values.pop("declared_torque_nm")
        values["torque_variation_nm"] = 0.2 * values["torque_nm"]
        return {**values, "shadow_dipole_am2": None, "shadow_impulse_nms": None}


NOT_DECLARED = ("non_orthogonality_deg", "eclipse_dipole_percent", "snap_radps")
CLOUDY = 0.3
"""Largest relative standard deviation of the Earth's light over the clouds."""
PENUMBRA_S = 10.0
"""What a satellite in low orbit takes to cross it, at least."""


@dataclass(frozen=True, slots=True)
class SatelliteKind:
    """A population: the scenario of the nominal satellite, and the bounds."""

    scenario: str
    tolerances: Tolerances


POPULATIONS: Mapping[str, SatelliteKind] = {
    "50kg": SatelliteKind("microsat", Tolerances((0.001, 0.1), torque_nm=3e-8, declared_torque_nm=3e-8)),
    "3u": SatelliteKind("cubesat3u", Tolerances((0.0005, 0.01), torque_nm=1e-9, declared_torque_nm=1e-9)),
    "6u": SatelliteKind("cubesat6u", Tolerances((0.001, 0.02), torque_nm=2e-9, declared_torque_nm=1.5e-7)),
}


def satellite(
    kind: str, seed: int, *, twice: bool = False, rate_degps: Interval | None = None, declared: bool = True
) -> Nested:
    """One satellite of a population, as overrides of the scenario of its kind.

    Args:
        kind: of ``POPULATIONS``.
        seed: 0 or more; a satellite for each.
        twice: the truth differs by twice as much; the declared bounds stay.
        rate_degps: least and most of the start rate, about any axis; None: up to ``START_DEGPS`` per axis.
        declared: the onboard table declares the bounds; otherwise it assumes ordinary ones.
    """
    chosen, factor = POPULATIONS[kind], 2.0 if twice else 1.0
    random, more, changing = (_stream(kind, seed, number) for number in ((), (1,), (2,)))
    nominal = nominal_scenario(chosen.scenario)
    body = nominal.body
    overrides = _hardware(random, chosen.tolerances, factor)
    overrides = merge(overrides, _skew(more, overrides, chosen.tolerances, factor))
    overrides = merge(overrides, _changes(changing, nominal, chosen.tolerances, factor))
    overrides["initial"] = _start(random, rate_degps)
    overrides["body"] = {
        "inertia_kgm2": _inertia(random, np.array(body.inertia), chosen.tolerances, factor).tolist()
    }
    overrides["flight"] = {"body": {"inertia_kgm2": list(body.inertia_kgm2)}}
    limits = chosen.tolerances.declared()
    overrides["flight"]["uncertainty"] = limits if declared else dict.fromkeys(limits)
    return overrides


def population_order(
    kind: str,
    seed: int,
    orbits: float,
    *,
    twice: bool = False,
    rate_degps: Interval | None = None,
    overrides: Nested | None = None,
) -> Order:
    """The flight of a satellite, with ``overrides`` laid over it, measured by ``consistency_figures``."""
    drawn = satellite(kind, seed, twice=twice, rate_degps=rate_degps)
    changed = merge(drawn, overrides or {})
    name = f"satellite {seed} of {kind}"
    return Order(POPULATIONS[kind].scenario, changed, seed, orbits, consistency_figures, name)


@cache
def nominal_scenario(name: str) -> Scenario:
    """A shipped scenario as it is."""
    return load(name)


def _stream(kind: str, seed: int, number: tuple[int, ...]) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(*kind.encode(), *number)))


def _hardware(random: np.random.Generator, tolerances: Tolerances, factor: float) -> Nested:
    """Dipole, coils, sensors, torque and orbit: all but the inertia."""

    def within(bound: float) -> Array:
        return factor * bound * random.uniform(-1.0, 1.0, 3)

    def turn(bound_deg: float) -> list[float]:
        turned: list[float] = (factor * bound_deg * random.uniform() * random_direction(random)).tolist()
        return turned

    least, most = np.log(tolerances.residual_dipole_am2)
    dipole = factor * np.exp(random.uniform(least, most)) * random_direction(random)
    daily_part = float(random.uniform())
    return {
        "disturbance": {
            "residual_dipole_am2": dipole.tolist(),
            "torque_nm": (within(tolerances.torque_nm) / (1.0 + daily_part)).tolist(),
            "torque_daily_part": daily_part,
        },
        "coils": {
            "dipole_scale": (1.0 + 0.01 * within(tolerances.coil_gain_percent)).tolist(),
            "misalignment_deg": [turn(tolerances.coil_misalignment_deg) for _ in range(3)],
        },
        "sensors": {
            "magnetometer": {
                "bias_nt": within(tolerances.magnetometer_bias_nt).tolist(),
                "scale": (1.0 + 0.01 * within(tolerances.magnetometer_scale_percent)).tolist(),
                "misalignment_deg": turn(tolerances.magnetometer_misalignment_deg),
                "latency_s": factor * tolerances.latency_s,
            },
            "sun": {
                "misalignment_deg": turn(tolerances.sun_misalignment_deg),
                "latency_s": factor * tolerances.latency_s,
            },
        },
        "orbit": {"along_track_km": float(within(tolerances.along_track_km)[0])},
    }


def _skew(random: np.random.Generator, drawn: Nested, tolerances: Tolerances, factor: float) -> Nested:
    """A magnetometer that is not orthogonal, for which the filter has no parameter.

    None of its axes is off by more than the bound on its misalignment, skew included.
    """
    turn_deg = float(np.linalg.norm(drawn["sensors"]["magnetometer"]["misalignment_deg"]))
    left_deg = (factor * tolerances.magnetometer_misalignment_deg - turn_deg) / sqrt(2.0)
    skew_deg = min(factor * tolerances.non_orthogonality_deg, left_deg) * random.uniform(-1.0, 1.0, 3)
    return {"sensors": {"magnetometer": {"non_orthogonality_deg": skew_deg.tolist()}}}


def _changes(random: np.random.Generator, nominal: Scenario, tolerances: Tolerances, factor: float) -> Nested:
    """What changes in orbit: bias, dipole, light of the Earth, field, and the rate at the shadow's edge."""

    def within(bound: float) -> list[float]:
        drawn: list[float] = (factor * bound * random.uniform(-1.0, 1.0, 3)).tolist()
        return drawn

    def part(bound: float) -> float:
        return factor * bound * float(random.uniform())

    dipole_am2 = 0.01 * tolerances.eclipse_dipole_percent * tolerances.residual_dipole_am2[1]
    impulse_nms = tolerances.snap_radps * mean_moment(nominal.body.inertia)
    return {
        "sensors": {
            "magnetometer": {
                "orbit_bias_nt": within(tolerances.magnetometer_orbit_nt),
                "orbit_bias_phase_deg": random.uniform(0.0, 360.0, 3).tolist(),
                "shadow_bias_nt": within(tolerances.magnetometer_shadow_nt),
            },
            "sun": {
                "albedo": part(0.01 * tolerances.albedo_percent / factor),
                "albedo_spread": CLOUDY * float(random.uniform()),
            },
        },
        "field": {"storm_nt": part(tolerances.storm_nt)},
        "disturbance": {
            "residual_dipole_eclipse_am2": (part(dipole_am2) * random_direction(random)).tolist(),
            "remanence_part": part(0.01 * tolerances.remanence_percent),
            "penumbra_torque_nm": within(impulse_nms / PENUMBRA_S),
        },
    }


def _start(random: np.random.Generator, rate_degps: Interval | None) -> Nested:
    axis, angle_deg = random_direction(random), random.uniform(0.0, START_DEG)
    slow_degps = START_DEGPS * random.uniform(-1.0, 1.0, 3)
    # drawn in either case: the same satellite tumbles
    direction, part = random_direction(random), random.uniform()
    if rate_degps is None:
        rate = slow_degps
    else:
        rate = (rate_degps[0] + part * (rate_degps[1] - rate_degps[0])) * direction
    return {"axis": axis.tolist(), "angle_deg": float(angle_deg), "rate_degps": rate.tolist()}


def _inertia(random: np.random.Generator, nominal: Array, tolerances: Tolerances, factor: float) -> Array:
    """A tensor near the nominal one, drawn last because it is redrawn until a rigid body can have it."""
    diagonal = np.diagonal(nominal)
    while True:
        moments = diagonal * (1.0 + 0.01 * factor * tolerances.inertia_percent * random.uniform(-1.0, 1.0, 3))
        products = (
            0.01 * factor * tolerances.products_percent * diagonal.mean() * random.uniform(-1.0, 1.0, 3)
        )
        upper = np.zeros((3, 3))
        upper[np.triu_indices(3, 1)] = products
        tensor: Array = np.diag(moments) + upper + upper.T
        if is_rigid(tensor):
            return tensor


def is_rigid(inertia_kgm2: Array) -> bool:
    """Whether a body can have this tensor: positive, no principal moment above the sum of the others."""
    principal = np.linalg.eigvalsh(inertia_kgm2)
    return bool(principal[0] > 0.0 and principal[2] < principal[0] + principal[1])


def random_direction(random: np.random.Generator) -> Array:
    """A unit vector, all directions alike, (3,)."""
    vector = random.standard_normal(3)
    unit: Array = vector / np.linalg.norm(vector)
    return unit
