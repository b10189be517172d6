"""How far the satellite of a scenario is off its onboard table, and by how much it may be.

A deviation has the unit of its bound, a key of ``[flight.uncertainty]``.
"""

from collections.abc import Iterator, Sequence
from math import degrees
from typing import NamedTuple

import numpy as np

from fsw.table.ordinary import mean_moment
from fsw.table.table import FlightTable
from fsw.table.uncertainty import Uncertainty
from sim.design.from_scenario import body_of
from sim.plant.config import PlantConfig
from sim.plant.sensor_config import MagnetometerConfig, SunSensorConfig
from sim.scenario.assemble import plant_config
from sim.scenario.residual_errors import coil_errors, magnetometer_errors, sun_turn_rad
from sim.scenario.schema import Scenario, flight_table
from sim.sizing.expectation import field_across

SLIGHT = 0.002
"""Part of what the coils can give that is of no consequence; by three times as much exact tables mislead."""
OF_DYNAMICS = ("body.", "coils.")
"""What matters to a controller with perfect knowledge."""


class Deviation(NamedTuple):
    """How far the satellite is off its table in what a key says, and the bound of that.

    Attributes:
        key: of the scenario.
        off: the deviation, by component.
        of_table: the key of its bound.
        bound: the most that is declared.
        slight: the most that is of no consequence, whatever the bound.
    """

    key: str
    off: Sequence[float]
    of_table: str
    bound: float
    slight: float

    @property
    def worst(self) -> float:
        """The largest component."""
        return max(map(abs, self.off))

    @property
    def words(self) -> str:
        """A clause that names both keys."""
        unit = " %" if self.of_table.endswith("_percent") else ""
        return (
            f"{self.key} is off by {self.worst:.3g}{unit}, and flight.uncertainty.{self.of_table} = "
            f"{self.bound:.4g}"
        )


def deviations(scenario: Scenario, known: Uncertainty) -> list[Deviation]:
    """All that follows from the keys, large or small; with perfect knowledge those of the dynamics.

    Args:
        scenario: the satellite, and its onboard table.
        known: the bounds that are stated.
    """
    table, plant = flight_table(scenario), plant_config(scenario, seed=0)
    found = [
        *_of_body(plant, table, known),
        *_of_disturbances(scenario, known),
        *_of_coils(plant, table, known),
        *_of_magnetometer(plant.magnetometer, table, known),
        *_of_sun(plant, table, known),
    ]
    perfect = scenario.knowledge == "perfect"
    return [one for one in found if not perfect or one.key.startswith(OF_DYNAMICS)]


def slight_disturbance(scenario: Scenario) -> tuple[float, float]:
    """Dipole (A m^2) and torque (N m) that are of no consequence beside what the coils give in the mean."""
    dipole_am2 = SLIGHT * scenario.coils.largest_am2 * scenario.coils.on_part
    return dipole_am2, dipole_am2 * field_across(body_of(scenario))


def _of_body(plant: PlantConfig, table: FlightTable, known: Uncertainty) -> Iterator[Deviation]:
    true, assumed = np.array(plant.body.inertia_kgm2), np.array(table.body.inertia)
    moments = 100.0 * (true.diagonal() / assumed.diagonal() - 1.0)
    products = 100.0 * (true - assumed)[np.triu_indices(3, 1)] / mean_moment(table.body.inertia)
    for off, of_table, part, slight in (
        (moments, "inertia_percent", known.inertia_part, 1.0),
        (products, "products_percent", known.products_part, 0.5),
    ):
        yield Deviation("body.inertia_kgm2", off.tolist(), of_table, 100.0 * part, slight)


def _of_disturbances(scenario: Scenario, known: Uncertainty) -> Iterator[Deviation]:
    given, (dipole_am2, torque_nm) = scenario.disturbance, slight_disturbance(scenario)
    in_shadow_am2, along_km = given.residual_dipole_eclipse_am2, (scenario.orbit.along_track_km,)
    for key, off, of_table, bound, slight in (
        ("disturbance.torque_nm", given.torque_nm, "torque_nm", known.torque_nm, torque_nm),
        (
            "disturbance.residual_dipole_am2",
            given.residual_dipole_am2,
            "residual_dipole_am2",
            known.dipole_am2,
            dipole_am2,
        ),
        (
            "disturbance.residual_dipole_eclipse_am2",
            in_shadow_am2,
            "shadow_dipole_am2",
            known.shadow_dipole_am2,
            dipole_am2,
        ),
        ("orbit.along_track_km", along_km, "along_track_km", 1e-3 * known.along_track_m, 1.0),
    ):
        yield Deviation(key, off, of_table, bound, slight)


def _of_coils(plant: PlantConfig, table: FlightTable, known: Uncertainty) -> Iterator[Deviation]:
    dipoles = coil_errors(plant.coils, table.calibration) + np.eye(3)
    lengths = np.linalg.norm(dipoles, axis=0)
    gains, gain = 100.0 * (lengths - 1.0), 100.0 * known.coil_gain_part
    turns_deg, turn_deg = np.degrees(dipoles / lengths - np.eye(3)), degrees(known.coil_turn_rad)
    yield Deviation("coils.dipole_scale", gains.tolist(), "coil_gain_percent", gain, 1.0)
    yield Deviation(
        "coils.misalignment_deg", turns_deg.ravel().tolist(), "coil_misalignment_deg", turn_deg, 0.5
    )
    if known.pulse_am2:
        kept, bound = 100.0 * plant.coils.remanence_part, 100.0 * known.remanence_part
        yield Deviation("disturbance.remanence_part", (kept,), "remanence_percent", bound, 0.05)


def _of_magnetometer(
    plant: MagnetometerConfig, table: FlightTable, known: Uncertainty
) -> Iterator[Deviation]:
    left, degree = magnetometer_errors(plant, table.calibration), degrees(1.0)
    for key, off, of_table, bound, unit, slight in (
        ("bias_nt", left.bias_t, "bias_nt", known.mag_bias_t, 1e9, 100.0),
        ("orbit_bias_nt", plant.orbit_bias_t, "orbit_nt", known.mag_orbit_t, 1e9, 100.0),
        ("shadow_bias_nt", plant.shadow_bias_t, "shadow_nt", known.mag_shadow_t, 1e9, 100.0),
        ("scale", left.scale, "scale_percent", known.mag_scale_part, 100.0, 0.3),
        ("misalignment_deg", left.turn_rad, "misalignment_deg", known.mag_turn_rad, degree, 0.2),
    ):
        yield Deviation(
            f"sensors.magnetometer.{key}",
            [unit * value for value in off],
            f"magnetometer_{of_table}",
            unit * bound,
            slight,
        )
    yield Deviation("sensors.magnetometer.latency_s", (plant.latency_s,), "latency_s", known.latency_s, 0.2)


def _of_sun(plant: PlantConfig, table: FlightTable, known: Uncertainty) -> Iterator[Deviation]:
    sun = plant.sun_sensor
    if isinstance(sun, SunSensorConfig):
        turn_deg = [degrees(turn) for turn in sun_turn_rad(sun, table.calibration)]
        bound_deg = degrees(known.sun_turn_rad)
        yield Deviation("sensors.sun.misalignment_deg", turn_deg, "sun_misalignment_deg", bound_deg, 0.2)
        light, bound = 100.0 * sun.albedo, 100.0 * known.albedo
        yield Deviation("sensors.sun.albedo", (light,), "albedo_percent", bound, 1.0)
        yield Deviation("sensors.sun.latency_s", (sun.latency_s,), "latency_s", known.latency_s, 0.2)
    elif table.cells is not None:
        nominal = table.cells.full_sun or (1.0,) * len(sun.cells)
        gains = [100.0 * (cell.gain / full - 1.0) for cell, full in zip(sun.cells, nominal, strict=True)]
        bound = 100.0 * known.cell_gain_part
        yield Deviation("sensors.cells.gain", gains, "cell_gain_percent", bound, 2.0)
        light, bound = 100.0 * (sun.albedo - table.cells.albedo), 100.0 * known.cell_light
        yield Deviation("sensors.cells.albedo", (light,), "cell_light_percent", bound, 2.0)
        yield Deviation("sensors.cells.latency_s", (sun.latency_s,), "latency_s", known.latency_s, 0.2)
