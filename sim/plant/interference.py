"""Interface by which a fault acts on the plant: between physics and boards."""

from typing import Final

from mypy_extensions import mypyc_attr

from sim.plant.coil_drive import CoilDrive
from sim.plant.rotation import Vec3


@mypyc_attr(allow_interpreted_subclasses=True)
class Interference:
    """Replaces the readings that boards get and the currents that flow. This one changes nothing."""

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The magnetometer's reading [T] as its board gets it."""
        return b_body_t, valid

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The Sun sensor's reading as its board gets it."""
        return sun_body, valid

    def cells(self, currents: tuple[float, ...]) -> tuple[float, ...]:
        """The currents of the Sun cells as their board gets them."""
        return currents

    def coil_drive(self, drive: CoilDrive) -> CoilDrive:
        """The currents that flow where the coil driver board commands ``drive``."""
        return drive


NO_INTERFERENCE: Final = Interference()
