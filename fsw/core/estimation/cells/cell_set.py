"""Coarse Sun cells: what each should show, by Sun, Earth and attitude.

A cell with the normal n shows, as a fraction of what it shows facing the Sun,

    c = n . s + A cos(zeta) (R / r)^2 ((1 + n . e) / 2)^2 + excess,

s and e being the directions to Sun and Earth, zeta the Sun's zenith angle, and A the albedo: the fraction of
the light that the Earth reflects. The second term is the Earth's light: (R / r)^2 is the view factor of a
plate that faces the Earth; tilting the plate multiplies it by nearly the square, in low orbits.

Departures from nominal are estimated: the gain of each cell, a constant that multiplies n . s; A, which
varies as the satellite passes over land, sea and clouds; and the excess, whatever a cell shows beyond that,
since clouds are not spread evenly. None is white noise. A is common to all cells: separate errors would be
taken to average out. The excess persists while the geometry does: it is a state of each cell, first-order
Markov in the angle by which the satellite rotates relative to Sun and Earth.
"""

from dataclasses import dataclass
from math import acos, cos, hypot, pi
from typing import final

from fsw.core.algebra.vector import Vec3, dot, norm, scale
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.sun import lit

GRAZING = 0.52
"""Largest cos(zeta) ((1 + n . e) / 2)^2 of a cell that faces the Sun: n . e is at most sin(zeta) there, and
cos(zeta) (1 + sin(zeta))^2 / 4 is largest where sin(zeta) = 2/3."""
SIGMAS = 4.0
"""Beyond this many standard deviations what a cell is wrong by is outside what the table allows."""


@final
@dataclass(frozen=True, slots=True)
class Shade:
    """Where the satellite shades a cell from the Sun: a cone, its axis and the cosine of its half-angle."""

    axis_body: Vec3
    cosine: float


@final
@dataclass(frozen=True, slots=True)
class CellSet:
    """The cells as the table has them.

    Attributes:
        normals_body: unit vectors, body axes, at most six.
        full_sun: what each sends while it faces the Sun.
        shades: by cell, the directions in which it is shaded.
        dark: below this fraction of full sunlight a cell counts as dark.
        sigma: white noise, as a fraction of full sunlight, as is the next.
        excess_sigma: standard deviation of the excess.
        gain_sigma: of the relative error of the gain.
        light_sigma: of the albedo.
        albedo: fraction of the sunlight that the Earth reflects; 0: its light is not modelled.
        step: of a current, fraction of full sunlight; 0: that of the bus.
    """

    normals_body: tuple[Vec3, ...]
    full_sun: tuple[float, ...]
    shades: tuple[tuple[Shade, ...], ...]
    dark: float
    sigma: float
    excess_sigma: float
    gain_sigma: float
    light_sigma: float
    albedo: float
    step: float = 0.0

    @property
    def model_sigma(self) -> float:
        """Standard deviation of all that a cell that sees Sun and Earth shows beyond its nominal model."""
        return hypot(self.excess_sigma, self.gain_sigma, self.light_sigma)

    @property
    def most_shaded(self) -> float:
        """The most that a cell turned towards the Sun shows while it is shaded from it.

        That is the Earth's light, ``GRAZING`` times the albedo at most, and what the cell may be wrong by.
        """
        errors = hypot(GRAZING * self.light_sigma, self.excess_sigma, self.sigma)
        return GRAZING * self.albedo + SIGMAS * errors

    def shaded(self, cell: int, s_body: Vec3, within_rad: float = 0.0) -> bool:
        """Whether the satellite itself shades a cell from a Sun in this direction, or within that angle."""
        for shade in self.shades[cell]:
            cosine = shade.cosine
            if within_rad > 0.0:
                cosine = cos(min(pi, acos(cosine) + within_rad))
            if dot(shade.axis_body, s_body) > cosine:
                return True
        return False

    def may_be_shaded(self, cell: int, current: float) -> bool:
        """Whether a cell that shows this fraction of full sunlight may be in a shade of its own."""
        return bool(self.shades[cell]) and current < self.most_shaded


@final
class Light:
    """What lights the cells: directions to Sun and Earth, eci; the Earth's light relative to the Sun's."""

    __slots__ = ("e_eci", "earth", "s_eci")

    def __init__(self, s_eci: Vec3, e_eci: Vec3, earth: float) -> None:
        self.s_eci = s_eci
        self.e_eci = e_eci
        self.earth = earth


PENUMBRA_M = 40e3
"""Farther than this from the shadow the Sun is whole: half the penumbra, errors of position and Earth."""


def light(r_eci_m: Vec3, s_eci: Vec3, albedo: float) -> Light | None:
    """What lights the cells; None in the shadow, and near its edge."""
    if not lit(r_eci_m, s_eci, RADIUS_M + PENUMBRA_M):
        return None
    radius_m = norm(r_eci_m)
    up = max(0.0, dot(r_eci_m, s_eci) / radius_m)
    return Light(s_eci, scale(-1.0 / radius_m, r_eci_m), albedo * up * (RADIUS_M / radius_m) ** 2)
