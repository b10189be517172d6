"""The disturbances: constant torque, residual dipole, drag, solar pressure, eddy currents and noise."""

from collections.abc import Callable, Iterator
from math import cos, pi, sqrt

from sim.plant.config import DisturbanceConfig, PlantConfig
from sim.plant.dynamics import surfaces, torques
from sim.plant.environment.orbit import DAY_S
from sim.plant.environment.surroundings import Surroundings
from sim.plant.random_streams import normals
from sim.plant.rotation import Mat3, Vec3, transform

Effect = Callable[[Mat3, Vec3, Surroundings], Vec3]
"""Torque, body axes [N m], from C(body from ``eci``), the inertial rate in body axes and the surroundings."""


def bias_torque(disturbance: DisturbanceConfig, t_s: float) -> Vec3:
    """T (1 + p cos(2 pi t / day)), body axes [N m]: constant torque T and its daily variation.

    It stands for what is not modelled, such as outgassing, and what varies daily, such as the air.

    Args:
        disturbance: T and p.
        t_s: time since tick 0.
    """
    if not disturbance.torque_daily_part:
        return disturbance.torque_body_nm
    factor = 1.0 + disturbance.torque_daily_part * cos(2.0 * pi * t_s / DAY_S)
    x, y, z = disturbance.torque_body_nm
    return (factor * x, factor * y, factor * z)


def residual_dipole(disturbance: DisturbanceConfig, lit: float, remanence_body_am2: Vec3) -> Vec3:
    """M = m_0 + (1 - lit) m_e + m_r, body axes [A m^2]: constant, from the Earth's shadow, by remanence.

    m_e is that of the loops in which a current starts or stops when the solar cells are in the dark: a
    residual dipole shifts suddenly as the currents on board vary (Soken and Sakai 2014, Investigation of
    Estimation Methods for Time-varying Residual Magnetic Moment).

    Args:
        disturbance: m_0 and m_e.
        lit: visible fraction of the Sun's disc.
        remanence_body_am2: m_r.
    """
    (x, y, z), (rx, ry, rz) = disturbance.residual_dipole_body_am2, remanence_body_am2
    dark, (ex, ey, ez) = 1.0 - lit, disturbance.residual_dipole_eclipse_body_am2
    return (x + dark * ex + rx, y + dark * ey + ry, z + dark * ez + rz)


def effects(config: PlantConfig) -> dict[str, Effect]:
    """The torques that follow from attitude, rate and surroundings, by name (``Plant.torque_sources``)."""
    found: dict[str, Effect] = {}
    disturbance, plates = config.disturbance, config.body.plates
    if disturbance.density_scale is not None:
        found["drag"] = lambda c, omega, around: surfaces.drag(
            plates, transform(c, around.exposure.flow_eci_mps), around.exposure.density_kgpm3
        )
    if disturbance.solar_flux_wpm2 is not None:
        found["solar_pressure"] = lambda c, omega, around: surfaces.solar_pressure(
            plates, transform(c, around.exposure.sun_eci), around.exposure.sunlight_pa
        )
    if eddy := disturbance.eddy_nms_per_t2:
        found["eddy"] = lambda c, omega, around: torques.eddy(eddy, omega, transform(c, around.b_eci_t))
    return found


def torque_noise(config: PlantConfig) -> Iterator[Vec3] | None:
    """A torque for each tick, constant over it, white from tick to tick; None where there is none.

    Its standard deviation per axis is sqrt(q tick_hz), q the spectral density of the white torque that it
    represents: over many ticks the integral of both has the variance q t. Stream ``torque_noise``.
    """
    root_density = config.disturbance.torque_noise_nm_rts
    if not root_density:
        return None
    sigma_nm, noise = root_density * sqrt(config.tick_hz), normals(config.seed, "torque_noise")
    return ((sigma_nm * x, sigma_nm * y, sigma_nm * z) for x, y, z in zip(noise, noise, noise, strict=False))
