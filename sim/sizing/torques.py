"""The disturbance torques on a satellite at rest in the nominal attitude, over one orbit."""

import numpy as np

from fsw.core.orbit.tle import tle_elements
from sim.design.from_scenario import body_of, law_from_body
from sim.design.theory.feedforward import NODES
from sim.design.theory.linear import dipole_field, resting_torque
from sim.plant.config import OrbitConfig
from sim.plant.dynamics import surfaces
from sim.plant.environment.atmosphere import altitude_m, density_kgpm3, flow_mps
from sim.plant.environment.orbit import CircularOrbit
from sim.plant.environment.sun import AU_M, illumination, sun_eci_m
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Array

LIGHT_MPS = 299792458.0


def disturbance_torque(scenario: Scenario) -> Array:
    """Torque at the nodes u = 2 pi k / N of the circular orbit, in the axes of the laws [N m], (N, 3).

    The sum of the constant torque, residual dipole x field of the direct dipole, drag and sunlight on the
    plates, and what the gravity gradient leaves on a body whose principal axes are not the body axes.
    """
    body = body_of(scenario)
    u = 2.0 * np.pi / NODES * np.arange(NODES, dtype=np.float64)
    turn = law_from_body(scenario)
    residual_am2 = turn @ np.asarray(scenario.disturbance.residual_dipole_am2)
    magnetic = np.cross(residual_am2, dipole_field(u, body) * body.field_t)
    constant = turn @ np.asarray(scenario.disturbance.torque_nm) + resting_torque(body)
    torque: Array = constant + magnetic + surface_torque(scenario) @ turn.T
    return torque


def surface_torque(scenario: Scenario) -> Array:
    """Drag and pressure of sunlight on the plates at the same nodes, body axes [N m], (N, 3)."""
    body, config, period_s = body_of(scenario), plant_config(scenario, 0), orbit_period_s(scenario)
    tle = scenario.orbit.tle
    raan_deg = scenario.orbit.raan_deg if tle is None else tle_elements(*tle).raan_deg
    orbit = CircularOrbit(
        OrbitConfig(
            altitude_m=1e3 * body.altitude_km,
            inclination_rad=float(np.radians(body.inclination_deg)),
            raan_rad=float(np.radians(raan_deg)),
        )
    )
    t_s = period_s / NODES * np.arange(NODES, dtype=np.float64)
    r_m, v_mps = orbit.at(t_s)
    sun_m = sun_eci_m(config.epoch_unix_s, t_s)
    radius_m = np.linalg.norm(r_m, axis=1, keepdims=True)
    ahead_mps = v_mps / np.linalg.norm(v_mps, axis=1, keepdims=True)
    radial = r_m / radius_m
    orbital = np.stack([radial, ahead_mps, np.cross(radial, ahead_mps)], axis=1)  # rows: orbital axes, eci
    axes = law_from_body(scenario).T @ orbital  # rows: body axes
    to_sun_m = sun_m - r_m
    distance_m = np.linalg.norm(to_sun_m, axis=1)
    section = config.disturbance
    density = (section.density_scale or 0.0) * density_kgpm3(altitude_m(r_m))
    pressure_pa = (section.solar_flux_wpm2 or 0.0) / LIGHT_MPS * (AU_M / distance_m) ** 2
    pressure_pa = pressure_pa * illumination(r_m, sun_m)
    flow = np.einsum("kij,kj->ki", axes, flow_mps(r_m, v_mps))
    sun = np.einsum("kij,kj->ki", axes, to_sun_m / distance_m[:, None])
    rows = []
    for k in range(NODES):
        air = surfaces.drag(config.body.plates, tuple(flow[k]), float(density[k]))
        light = surfaces.solar_pressure(config.body.plates, tuple(sun[k]), float(pressure_pa[k]))
        rows.append(np.add(air, light))
    return np.array(rows)
