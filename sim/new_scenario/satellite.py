"""The few figures that a new scenario is made of, and what follows from them."""

from dataclasses import dataclass
from datetime import UTC, datetime
from math import pi, sqrt

from fsw.core.orbit.tle import tle_elements
from fsw.table.inertia import check_inertia
from sim.design.theory.bodies import EARTH_RADIUS_KM, MU_M3PS2, Body, diagonal
from sim.design.theory.linear import Gains
from sim.design.theory.search import natural_gains
from sim.errors import HarnessError
from sim.sizing.levels import Levels, levels_for, two_digits
from sim.value_types import Vec3

PULSE_S = 3.0
AXES = ("x", "y", "z")
LEAST_PART = 16.0
"""The strongest level over the least one, at least: each is four times the one before."""
RANGES = {
    "altitude_km": (150.0, 40_000.0),
    "inclination_deg": (0.0, 180.0),
    "mass_kg": (0.01, 1e6),
    "size_m": (0.01, 100.0),
    "inertia_kgm2": (1e-7, 1e9),
    "levels_am2": (1e-6, 1e5),
    "dipole_am2": (1e-6, 1e5),
    "magnetometer_nt": (0.0, 1e6),
    "sun_deg": (0.0, 90.0),
}
"""What a figure may be: from a PocketQube to a space station."""
DAMPING = 2.0
"""Times the natural damping gain."""
_NODE_DAYS_S = 86400.0


@dataclass(frozen=True, slots=True)
class NewSatellite:
    """What the user gives.

    Attributes:
        name: of the scenario.
        tle: two lines; None: a circular orbit.
        altitude_km: of the circular orbit.
        inclination_deg: of the circular orbit.
        mass_kg: with ``size_m`` in place of the inertia.
        size_m: edges of a homogeneous box along x, y, z; unless ``axes`` says otherwise the longest looks up,
            and the shortest points along the orbit's normal.
        inertia_kgm2: principal moments; None: from mass and size.
        levels_am2: of the coils; None: as ``sim.sizing`` suggests.
        axes: which of x, y, z look up, ahead and along the orbit's normal; None: x, y, z, or by the edges.
        dipole_am2: the largest of a coil, from which the levels follow; None: as suggested.
        continuous: the coils are driven continuously, without the limits of pulses.
        cells: Sun cells on the six sides in place of a Sun sensor.
        per_coil: each coil has a back-off of its own.
        magnetometer_nt: noise, standard deviation.
        sun_deg: noise of the Sun sensor.
        exact: the onboard table is right but for bias, residual dipole and torque; else its bounds are
            ordinary ones.
        epoch: time of tick 0 of a circular orbit.
    """

    name: str
    tle: tuple[str, str] | None = None
    altitude_km: float | None = None
    inclination_deg: float | None = None
    mass_kg: float | None = None
    size_m: Vec3 | None = None
    inertia_kgm2: Vec3 | None = None
    levels_am2: Levels | None = None
    axes: tuple[str, str, str] | None = None
    dipole_am2: float | None = None
    continuous: bool = False
    cells: bool = False
    per_coil: bool = False
    magnetometer_nt: float = 200.0
    sun_deg: float = 0.5
    exact: bool = True
    epoch: datetime = datetime(2025, 3, 20, 9, tzinfo=UTC)

    def check(self) -> None:
        """Check that the figures are those of a satellite.

        Raises:
            HarnessError: one is not; the message names it and what is allowed.
        """
        for name, (least, most) in RANGES.items():
            given = getattr(self, name)
            for value in given if isinstance(given, tuple) else (given,):
                if value is not None and not least <= value <= most:
                    option = name.replace("_", "-")
                    raise HarnessError(f"--{option}: {value:g} is not allowed: {least:g} to {most:g} is")
        if self.axes is not None and sorted(self.axes) != list(AXES):
            given = " ".join(self.axes)
            raise HarnessError(
                f"--axes: {given!r} is not allowed: x, y and z, each once, the one that looks up first"
            )
        if self.levels_am2 is not None and self.dipole_am2 is not None:
            raise HarnessError("--levels-am2 and --dipole-am2 exclude each other")
        if self.levels_am2 is not None and len(set(self.levels_am2)) == 1:
            level = self.levels_am2[0]
            raise HarnessError(
                "--levels-am2: three equal levels are one: they are the dipoles of each coil, least first; "
                f"for coils of {level:g} A m^2 give --dipole-am2 {level:g}"
            )
        try:
            check_inertia(diagonal(self.body_moments_kgm2))
        except ValueError as error:
            raise HarnessError(f"--inertia-kgm2: {error}") from None

    @property
    def looking(self) -> tuple[str, str, str]:
        """The body axes that look up, ahead and along the orbit's normal."""
        if self.axes is not None:
            return self.axes
        if self.inertia_kgm2 is not None or self.size_m is None:
            return AXES
        size_m = self.size_m
        up, ahead, normal = sorted(range(3), key=lambda axis: -size_m[axis])
        return AXES[up], AXES[ahead], AXES[normal]

    @property
    def body_moments_kgm2(self) -> Vec3:
        """The principal moments about x, y, z: given, or m/12 (b^2 + c^2) of the box.

        Raises:
            HarnessError: neither inertia nor mass and size are given.
        """
        if self.inertia_kgm2 is not None:
            return self.inertia_kgm2
        if self.mass_kg is None or self.size_m is None:
            raise HarnessError("give --inertia-kgm2 A B C, or --mass-kg and --size-m A B C")
        a, b, c = self.size_m
        factor = self.mass_kg / 12.0
        return factor * (b * b + c * c), factor * (a * a + c * c), factor * (a * a + b * b)

    @property
    def moments_kgm2(self) -> Vec3:
        """Those about the axes that look up, ahead and along the orbit's normal.

        Raises:
            HarnessError: as for ``body_moments_kgm2``.
        """
        up, ahead, normal = (self.body_moments_kgm2[AXES.index(axis)] for axis in self.looking)
        return up, ahead, normal

    @property
    def body(self) -> Body:
        """Inertia and circular orbit.

        Raises:
            HarnessError: no orbit is given.
        """
        if self.tle is not None:
            elements = tle_elements(*self.tle)
            period_s = _NODE_DAYS_S / elements.motion_revpday
            altitude_km = 1e-3 * (MU_M3PS2 * (period_s / (2.0 * pi)) ** 2) ** (1.0 / 3.0) - EARTH_RADIUS_KM
            return Body(self.name, diagonal(self.moments_kgm2), altitude_km, elements.inclination_deg)
        if self.altitude_km is None or self.inclination_deg is None:
            raise HarnessError("give --tle FILE, or --altitude-km and --inclination-deg")
        return Body(self.name, diagonal(self.moments_kgm2), self.altitude_km, self.inclination_deg)

    @property
    def levels(self) -> Levels:
        """The levels given, those below the dipole given, or those of a body without disturbances."""
        if self.levels_am2 is not None:
            return self.levels_am2
        usual = levels_for(self.body, PULSE_S)
        if self.dipole_am2 is None:
            return usual
        least = min(usual[0], self.dipole_am2 / LEAST_PART)
        return two_digits(least), two_digits(sqrt(least * self.dipole_am2)), self.dipole_am2


def gains_for(body: Body) -> Gains:
    """Gains of the pd law that come to rest from any attitude: the natural ones, with twice the damping.

    The best degree of stability at small angles takes up to four times as much k_a / k_w. With it three of
    nine cubesats did not come to rest within eight orbits from some of four starts at 40 to 150 deg; with
    these all did within three. ``torquer design`` finds the best at small angles.
    """
    natural = natural_gains(body)
    return Gains(two_digits(float(DAMPING * natural.k_w)), two_digits(float(natural.k_a)))
