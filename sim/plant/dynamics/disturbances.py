"""The disturbances: constant torque, residual dipole, drag, solar pressure, eddy currents and noise."""

from math import cos, pi, sqrt
from typing import final

from sim.plant.config import DisturbanceConfig, PlantConfig, PlateConfig
from sim.plant.dynamics import surfaces, torques
from sim.plant.environment.orbit import DAY_S
from sim.plant.environment.surroundings import Surroundings
from sim.plant.random_streams import Normals
from sim.plant.rotation import Mat3, Vec3, transform


def bias_torque(disturbance: DisturbanceConfig, t_s: float, lit: float = 1.0) -> Vec3:
    """T (1 + p cos(2 pi t / day)) + T_p, body axes [N m]: constant and varying daily; of the penumbra.

    The first stands for what is not modelled, such as outgassing, and what varies daily, such as the air. The
    second acts while the Sun is partly hidden: a body that warms or cools fast snaps (Thornton and Kim 1993,
    Thermally induced bending vibrations of a flexible rolled-up solar array).

    Args:
        disturbance: T, p and T_p.
        t_s: time since tick 0.
        lit: visible fraction of the Sun's disc.
    """
    x, y, z = disturbance.torque_body_nm
    if disturbance.torque_daily_part:
        factor = 1.0 + disturbance.torque_daily_part * cos(2.0 * pi * t_s / DAY_S)
        x, y, z = factor * x, factor * y, factor * z
    if 0.0 < lit < 1.0:
        px, py, pz = disturbance.penumbra_torque_body_nm
        x, y, z = x + px, y + py, z + pz
    return (x, y, z)


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


@final
class Drag(torques.Effect):
    """Of the air on plates."""

    def __init__(self, plates: tuple[PlateConfig, ...]) -> None:
        self._plates = plates

    def at(self, body_from_eci: Mat3, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """The torque, as in ``surfaces.drag``."""
        exposure = around.exposure
        flow_body_mps = transform(body_from_eci, exposure.flow_eci_mps)
        return surfaces.drag(self._plates, flow_body_mps, exposure.density_kgpm3)


@final
class SolarPressure(torques.Effect):
    """Of sunlight on plates."""

    def __init__(self, plates: tuple[PlateConfig, ...]) -> None:
        self._plates = plates

    def at(self, body_from_eci: Mat3, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """The torque, as in ``surfaces.solar_pressure``."""
        exposure = around.exposure
        sun_body = transform(body_from_eci, exposure.sun_eci)
        return surfaces.solar_pressure(self._plates, sun_body, exposure.sunlight_pa)


@final
class EddyCurrents(torques.Effect):
    """Of the currents that the field induces."""

    def __init__(self, k_nms_per_t2: float) -> None:
        self._k_nms_per_t2 = k_nms_per_t2

    def at(self, body_from_eci: Mat3, omega_body_radps: Vec3, around: Surroundings) -> Vec3:
        """The torque, as in ``torques.eddy``."""
        b_body_t = transform(body_from_eci, around.b_eci_t)
        return torques.eddy(self._k_nms_per_t2, omega_body_radps, b_body_t)


def effects(config: PlantConfig) -> dict[str, torques.Effect]:
    """The torques that follow from attitude, rate and surroundings, by name (``Plant.torque_sources``)."""
    found: dict[str, torques.Effect] = {}
    disturbance, plates = config.disturbance, config.body.plates
    if disturbance.density_scale is not None:
        found["drag"] = Drag(plates)
    if disturbance.solar_flux_wpm2 is not None:
        found["solar_pressure"] = SolarPressure(plates)
    if disturbance.eddy_nms_per_t2:
        found["eddy"] = EddyCurrents(disturbance.eddy_nms_per_t2)
    return found


@final
class TorqueNoise:
    """A torque for each tick, constant over it, white from tick to tick.

    Its standard deviation per axis is sqrt(q tick_hz), q the spectral density of the white torque that it
    represents: over many ticks the integral of both has the variance q t. Stream ``torque_noise``.

    Args:
        root_density_nm_rts: sqrt(q).
        seed: of the stream.
        tick_hz: ticks a second.
    """

    def __init__(self, root_density_nm_rts: float, seed: int, tick_hz: int) -> None:
        self._sigma_nm = root_density_nm_rts * sqrt(tick_hz)
        self._noise = Normals(seed, "torque_noise")

    def next(self) -> Vec3:
        """That of the next tick, body axes [N m]."""
        sigma_nm, noise = self._sigma_nm, self._noise
        x, y, z = noise.next(), noise.next(), noise.next()
        return (sigma_nm * x, sigma_nm * y, sigma_nm * z)
