"""The torque of sunlight on two flaps that are turned against each other."""

from dataclasses import dataclass
from math import cos, radians, sin

from fsw.input.quantities import quantity
from sim.plant.config import PlateConfig
from sim.plant.dynamics.surfaces import solar_pressure
from sim.plant.own_effects import Moment
from sim.plant.rotation import Vec3

SUNLIGHT_PA = 4.54e-6
"""Of 1361 W/m^2, one astronomical unit from the Sun."""


@dataclass(frozen=True)
class SolarFlaps:
    """Two flaps at the ends of a boom along body axis 2, turned about it.

    The flap on +2 has its normal in the plane of axes 1 and 3 at ``plus_deg`` from axis 1 to axis 3, that on
    -2 at ``minus_deg``; both sides alike.
    """

    area_m2: float = quantity(0.1, "m^2", least=0.0, most=100.0)
    arm_m: float = quantity(1.0, "m", least=0.0, most=100.0)
    plus_deg: float = quantity(0.0, "deg", least=-180.0, most=180.0)
    minus_deg: float = quantity(90.0, "deg", least=-180.0, most=180.0)
    specular: float = quantity(0.0, "", least=0.0, most=1.0)

    def torque_body_nm(self, moment: Moment) -> Vec3:
        """Of the light on both, none in the Earth's shadow, body axes, N m."""
        return solar_pressure(self.plates(), moment.sun_body, SUNLIGHT_PA * moment.lit)

    def plates(self) -> tuple[PlateConfig, ...]:
        """Both sides of both flaps.

        Source: Modi, Pande 1974, as in Ovchinnikov, Roldugin 2019, section 2.4 [66]: solar pressure on
        flaps beside magnets, near the equator, where the field leaves one axis without torque. The shape is
        of this project, the force that of ``solar_pressure``.
        """
        return tuple(
            PlateConfig(
                area_m2=self.area_m2,
                normal_body=(side * cos(radians(turn)), 0.0, side * sin(radians(turn))),
                centre_body_m=(0.0, end * self.arm_m, 0.0),
                specular=self.specular,
            )
            for end, turn in ((1.0, self.plus_deg), (-1.0, self.minus_deg))
            for side in (1.0, -1.0)
        )
