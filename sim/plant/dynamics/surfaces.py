"""Torques of air and light on flat plates, in body axes. No plate shades another."""

from collections.abc import Sequence

from sim.plant.config import PlateConfig
from sim.plant.rotation import Vec3, cross


def drag(plates: Sequence[PlateConfig], flow_body_mps: Vec3, density_kgpm3: float) -> Vec3:
    """T = sum of r x F, F = -1/2 rho C_D A |v| v max(0, cos), cos = n . v / |v|.

    Markley and Crassidis 2014, section 3.3.6.

    Args:
        plates: the surface.
        flow_body_mps: velocity v of the satellite relative to the air.
        density_kgpm3: of the air.
    """
    vx, vy, vz = flow_body_mps
    sx = sy = sz = 0.0
    for plate in plates:
        nx, ny, nz = plate.normal_body
        towards_mps = nx * vx + ny * vy + nz * vz
        if towards_mps > 0.0:
            weight = plate.drag_coefficient * plate.area_m2 * towards_mps
            x, y, z = plate.centre_body_m
            sx, sy, sz = sx + weight * x, sy + weight * y, sz + weight * z
    tx, ty, tz = cross((sx, sy, sz), flow_body_mps)
    factor = -0.5 * density_kgpm3
    return (factor * tx, factor * ty, factor * tz)


def solar_pressure(plates: Sequence[PlateConfig], sun_body: Vec3, pressure_pa: float) -> Vec3:
    """T = sum of r x F, F = -P A cos (2 (d/3 + s cos) n + (1 - s) e), cos = n . e > 0, otherwise none.

    s and d are the fractions reflected specularly and diffusely (Lambert); the rest is absorbed
    (Markley and Crassidis 2014, 3.3.6).

    Args:
        plates: the surface.
        sun_body: unit vector e to the Sun.
        pressure_pa: P of the light on a black plate that faces the Sun; none in the Earth's shadow.
    """
    if not pressure_pa:
        return (0.0, 0.0, 0.0)
    ex, ey, ez = sun_body
    tx = ty = tz = 0.0
    for plate in plates:
        nx, ny, nz = plate.normal_body
        cosine = nx * ex + ny * ey + nz * ez
        if cosine > 0.0:
            force = -pressure_pa * plate.area_m2 * cosine
            along_n = 2.0 * force * (plate.diffuse / 3.0 + plate.specular * cosine)
            along_e = force * (1.0 - plate.specular)
            x, y, z = cross(
                plate.centre_body_m,
                (along_n * nx + along_e * ex, along_n * ny + along_e * ey, along_n * nz + along_e * ez),
            )
            tx, ty, tz = tx + x, ty + y, tz + z
    return (tx, ty, tz)
