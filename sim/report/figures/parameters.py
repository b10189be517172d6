"""What the filter estimates besides attitude and rate, with the bounds of its table and the truth."""

from fsw.core.estimation.mekf import Estimate, healthy
from fsw.core.estimation.parameters import MOST_CELLS, layout
from fsw.table.cells import CellTable
from fsw.table.estimator import table_bounds
from fsw.table.table import FlightTable
from fsw.table.uncertainty import limits, priors
from sim.plant.config import PlantConfig
from sim.plant.dynamics.disturbances import bias_torque, effects, residual_dipole
from sim.plant.rotation import ZERO
from sim.plant.sensor_config import SunCellsConfig, SunSensorConfig
from sim.record.truth import Histories
from sim.scenario.assemble import plant_config
from sim.scenario.residual_errors import coil_errors, magnetometer_errors, sun_turn_rad
from sim.scenario.schema import Scenario, flight_table
from sim.value_types import Json

Values = tuple[float, ...]


def parameter_figures(scenario: Scenario, truth: Histories, estimate: Estimate | None) -> Json | None:
    """The last estimate of each parameter that the filter carries; None where there is no sound one.

    By name in ``Parameters``, each a list by component, SI units: ``value``, ``sigma``, ``bound`` of the
    onboard table, and ``truth`` where the plant has one.
    """
    table = flight_table(scenario)
    if estimate is None or not healthy(estimate):
        return None
    known, inertia = table_bounds(table), table.body.inertia
    bounds, true = limits(known, inertia), true_parameters(scenario, table, truth)
    sigma = estimate.covariance.diagonal() ** 0.5
    figures: Json = {}
    for name, place in layout(set(priors(known, inertia))).carried:
        figures[name] = {
            "value": list(getattr(estimate.parameters, name)),
            "sigma": sigma[place].tolist(),
            "bound": list(bounds[name]),
        }
        if name in true:
            figures[name]["truth"] = list(true[name])
    return figures


def true_parameters(scenario: Scenario, table: FlightTable, truth: Histories) -> dict[str, Values]:
    """The true parameters; those of sensors and coils are relative to their calibration.

    Torque and dipole, which may vary, are those at the end, without remanence.
    """
    plant, calibration = plant_config(scenario, seed=0), table.calibration
    magnetometer = magnetometer_errors(plant.magnetometer, calibration)
    true = {
        "mag_bias_t": magnetometer.bias_t,
        "dipole_body_am2": residual_dipole(plant.disturbance, truth["lit"][-1], ZERO),
        "coil_error": tuple(coil_errors(plant.coils, calibration).ravel().tolist()),
        "inertia_error_kgm2": _inertia_error(plant, table),
        "mag_turn_rad": magnetometer.turn_rad,
        "mag_scale": magnetometer.scale,
        "delay_s": (plant.magnetometer.latency_s, plant.sun_sensor.latency_s),
    }
    if isinstance(plant.sun_sensor, SunSensorConfig):  # cells are misaligned each by itself
        true["sun_turn_rad"] = sun_turn_rad(plant.sun_sensor, calibration)
        true["earth_light"] = (plant.sun_sensor.albedo,)
    elif table.cells is not None:
        true |= _of_cells(plant.sun_sensor, table.cells)
    if not effects(plant):  # torques that depend on the motion have no single value
        true["torque_body_nm"] = bias_torque(plant.disturbance, truth["t_s"][-1])
    return true


def _of_cells(true: SunCellsConfig, assumed: CellTable) -> dict[str, Values]:
    """Their lasting errors: a gain for each that the filter has room for, and the mean albedo."""
    nominal = assumed.full_sun or (1.0,) * len(true.cells)
    gains = [cell.gain / full - 1.0 for cell, full in zip(true.cells, nominal, strict=True)]
    light = {"earth_light": (true.albedo - assumed.albedo,)} if assumed.albedo else {}
    return {"cell_gain": (*gains, *(0.0,) * (MOST_CELLS - len(gains))), **light}


def _inertia_error(plant: PlantConfig, table: FlightTable) -> Values:
    """As xx, yy, zz, xy, xz, yz."""
    true, assumed = plant.body.inertia_kgm2, table.body.inertia
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return tuple(true[row][column] - assumed[row][column] for row, column in places)
