"""Coarse Sun cells: what each should show, by Sun, Earth and attitude.

A cell with the normal n shows, in parts of what it shows facing the Sun,

    c = n . s + A cos(zeta) (R / r)^2 ((1 + n . e) / 2)^2 + excess,

s and e being the directions to Sun and Earth, zeta the Sun's distance from the zenith, and A the part of the
light that the Earth reflects. The second term is the Earth's light: (R / r)^2 is the view factor of a plate
that faces the Earth; one that is turned away sees what the square leaves of it, nearly, in low orbits.

What is not the nominal one is estimated: the gain of each cell, a constant that multiplies n . s; A, which
wanders as the satellite passes over land, sea and clouds; and the excess, whatever a cell shows beyond that,
since clouds are not spread evenly. None is white noise. A is one for all cells: errors that each had for
itself would be taken to average out. The excess stays while the geometry does: it is a state of each cell,
first-order Markov over the angle that the satellite turns by against Sun and Earth.
"""

from dataclasses import dataclass
from math import hypot
from typing import NamedTuple

from fsw.core.algebra.vector import Vec3, dot, norm, scale
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.sun import lit


class Shade(NamedTuple):
    """Where the satellite takes the Sun from a cell: a cone, its axis and the cosine of half its angle."""

    axis_body: Vec3
    cosine: float


@dataclass(frozen=True, slots=True)
class CellSet:
    """The cells as the table has them.

    Attributes:
        normals_body: unit vectors, body axes, at most six.
        full_sun: what each sends while it faces the Sun.
        shades: by cell, from where it is shaded.
        dark: below this part of full sunlight a cell counts as dark.
        sigma: white noise, parts of full sunlight, as the next.
        excess_sigma: standard deviation of the excess.
        gain_sigma: of the relative error of the gain.
        light_sigma: of the albedo.
        albedo: part of the sunlight that the Earth reflects; 0: its light is not reckoned with.
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

    @property
    def model_sigma(self) -> float:
        """Standard deviation of what a cell that sees Sun and Earth shows beyond its model, all together."""
        return hypot(self.excess_sigma, self.gain_sigma, self.light_sigma)

    def shaded(self, cell: int, s_body: Vec3) -> bool:
        """Whether the satellite itself takes this direction of the Sun from a cell."""
        return any([dot(shade.axis_body, s_body) > shade.cosine for shade in self.shades[cell]])


class Light(NamedTuple):
    """What lights the cells: directions to Sun and Earth, eci; the Earth's light in parts of the Sun's."""

    s_eci: Vec3
    e_eci: Vec3
    earth: float


PENUMBRA_M = 40e3
"""So far from the edge of the shadow the Sun is whole: half of the penumbra, errors of place and Earth."""


def light(r_eci_m: Vec3, s_eci: Vec3, albedo: float) -> Light | None:
    """What lights the cells; None in the shadow, and near its edge."""
    if not lit(r_eci_m, s_eci, RADIUS_M + PENUMBRA_M):
        return None
    radius_m = norm(r_eci_m)
    up = max(0.0, dot(r_eci_m, s_eci) / radius_m)
    return Light(s_eci, scale(-1.0 / radius_m, r_eci_m), albedo * up * (RADIUS_M / radius_m) ** 2)
