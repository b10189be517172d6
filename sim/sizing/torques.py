"""Field and disturbance torques along an orbit, on a satellite at rest in the nominal attitude.

By the plant's models. The Earth turns under the orbit: field and torques depend on the hour of the day.
"""

from dataclasses import dataclass

import numpy as np

from fsw.input.schema import TableError
from sim.design.from_scenario import body_of, law_from_body
from sim.design.theory.feedforward import NODES
from sim.design.theory.linear import resting_torque
from sim.plant.dynamics import surfaces
from sim.plant.environment.atmosphere import altitude_m, density_kgpm3, flow_mps
from sim.plant.environment.field import make_field
from sim.plant.environment.orbit import make_orbit
from sim.plant.environment.sun import AU_M, illumination, sun_eci_m
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Array

LIGHT_MPS = 299792458.0
DAY_S = 86400.0


@dataclass(frozen=True, slots=True)
class OrbitNodes:
    """One orbit of a satellite at equal steps of time.

    Attributes:
        t_s: time since the epoch, (N,).
        r_eci_m: position, (N, 3).
        v_eci_mps: velocity, (N, 3).
        orbit_from_eci: matrices whose rows are the orbital axes, eci, (N, 3, 3).
        b_orbit_t: field, orbital axes, (N, 3).
    """

    t_s: Array
    r_eci_m: Array
    v_eci_mps: Array
    orbit_from_eci: Array
    b_orbit_t: Array


def day_of(scenario: Scenario) -> list[OrbitNodes]:
    """The orbits of a day from the epoch on: at least the first, and those for which elements and field hold.

    Raises:
        TableError: they do not hold in the first.
    """
    orbits = [orbit_nodes(scenario)]
    for number in range(1, round(DAY_S / orbit_period_s(scenario))):
        try:
            orbits.append(orbit_nodes(scenario, number))
        except TableError:
            break
    return orbits


def orbit_nodes(scenario: Scenario, number: float = 0.0) -> OrbitNodes:
    """The nodes t = (number + k / N) T of an orbit; the first is number 0.

    Raises:
        TableError: the elements have no position in it, or the field no value.
    """
    config = plant_config(scenario, 0)
    t_s = orbit_period_s(scenario) * (number + np.arange(NODES, dtype=np.float64) / NODES)
    try:
        r_m, v_mps = make_orbit(config.orbit, config.epoch_unix_s).at(t_s)
    except ValueError as error:
        raise TableError(f"orbit.tle: {error}") from None
    try:
        b_eci_t = make_field(config.field, config.epoch_unix_s).at(t_s, r_m)
    except ValueError as error:
        raise TableError(f"time.epoch_utc, and an orbit from it on: {error}") from None
    up, normal = _unit(r_m), _unit(np.cross(r_m, v_mps))
    axes = np.stack([up, np.cross(normal, up), normal], axis=1)
    return OrbitNodes(t_s, r_m, v_mps, axes, np.einsum("kij,kj->ki", axes, b_eci_t))


def disturbance_torque(scenario: Scenario, nodes: OrbitNodes) -> Array:
    """Torque at the nodes, in the axes of the laws [N m], (N, 3).

    The sum of the constant torque, residual dipole x field, drag and sunlight on the plates, and what the
    gravity gradient leaves on a body whose principal axes are not the body axes.
    """
    turn = law_from_body(scenario)
    residual_am2 = turn @ np.asarray(scenario.disturbance.residual_dipole_am2)
    constant = turn @ np.asarray(scenario.disturbance.torque_nm) + resting_torque(body_of(scenario))
    torque: Array = constant + np.cross(residual_am2, nodes.b_orbit_t)
    return torque + surface_torque(scenario, nodes) @ turn.T


def surface_torque(scenario: Scenario, nodes: OrbitNodes) -> Array:
    """Drag and pressure of sunlight on the plates at the nodes, body axes [N m], (N, 3)."""
    config = plant_config(scenario, 0)
    section, plates = config.disturbance, config.body.plates
    r_m, sun_m = nodes.r_eci_m, sun_eci_m(config.epoch_unix_s, nodes.t_s)
    axes = law_from_body(scenario).T @ nodes.orbit_from_eci  # rows: body axes
    to_sun_m = sun_m - r_m
    distance_m = np.linalg.norm(to_sun_m, axis=1)
    density = (section.density_scale or 0.0) * density_kgpm3(altitude_m(r_m))
    pressure_pa = (section.solar_flux_wpm2 or 0.0) / LIGHT_MPS * (AU_M / distance_m) ** 2
    pressure_pa = pressure_pa * illumination(r_m, sun_m)
    flow = np.einsum("kij,kj->ki", axes, flow_mps(r_m, nodes.v_eci_mps))
    sun = np.einsum("kij,kj->ki", axes, to_sun_m / distance_m[:, None])
    rows = []
    for k in range(NODES):
        air = surfaces.drag(plates, tuple(flow[k]), float(density[k]))
        light = surfaces.solar_pressure(plates, tuple(sun[k]), float(pressure_pa[k]))
        rows.append(np.add(air, light))
    return np.array(rows)


def _unit(vectors: Array) -> Array:
    unit: Array = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit
