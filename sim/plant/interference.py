"""Where a fault may reach into the plant: between physics and boards."""

from sim.plant.hardware.actuators import Driven
from sim.plant.rotation import Vec3


class Interference:
    """What the boards are given in place of the truth. This one leaves everything as it is."""

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The magnetometer's reading [T] as its board gets it."""
        return b_body_t, valid

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The Sun sensor's reading as its board gets it."""
        return sun_body, valid

    def driven(self, driven: Driven) -> Driven:
        """What flows where the coil driver's board means to drive this."""
        return driven


NO_INTERFERENCE = Interference()
