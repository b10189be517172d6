"""What the coils do at this moment: the dipole that is driven, and its torque in the field."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fsw.core.algebra.quaternion import IDENTITY, Quaternion
from fsw.core.algebra.vector import Vec3, cross
from sim.drawing.cuboid import sides
from sim.scenario.schema import Scenario


@dataclass(frozen=True, slots=True)
class Craft:
    """What the view takes from a scenario, and no frame tells.

    Attributes:
        levels_am2: dipoles of levels 1, 2, 3.
        full_am2: the full dipole of a continuous driver.
        sides: of the body as it is drawn.
        q_law_from_body: the turn to the axes that look up, ahead and along the orbit's normal.
    """

    levels_am2: Vec3
    full_am2: float
    sides: Vec3
    q_law_from_body: Quaternion


def craft_of(scenario: Scenario) -> Craft:
    """That of a scenario."""
    one, two, three = sides(np.array(scenario.body.inertia)).tolist()
    axes = scenario.body.law_axes
    turn = IDENTITY if axes is None else axes.q_law_from_body
    return Craft(scenario.coils.levels_am2, scenario.coils.largest_am2, (one, two, three), turn)


@dataclass(frozen=True, slots=True)
class CoilTorque:
    """Dipole and torque, body axes: A m^2 and N m, or directions alone where the satellite is not known.

    Attributes:
        dipole: that is driven.
        torque: dipole x field; None where no field is known.
        in_units: whether the sizes mean something.
    """

    dipole: Vec3
    torque: Vec3 | None
    in_units: bool


def coil_torque(
    levels: Sequence[int], fractions: Vec3 | None, b_body_t: Vec3 | None, craft: Craft | None
) -> CoilTorque | None:
    """By the levels of a pulsed driver, or the parts of the full dipole of a continuous one.

    Args:
        levels: of the pulses under way, by coil.
        fractions: of the full dipole; None of a pulsed driver.
        b_body_t: field, body axes.
        craft: of the satellite, if it is known.

    Returns:
        None where no coil is driven.
    """
    if fractions is not None:
        full_am2 = 1.0 if craft is None else craft.full_am2
        one, two, three = (full_am2 * part for part in fractions)
    else:
        one, two, three = (_dipole(level, craft) for level in levels)
    dipole = (one, two, three)
    if not any(dipole):
        return None
    return CoilTorque(dipole, None if b_body_t is None else cross(dipole, b_body_t), craft is not None)


def _dipole(level: int, craft: Craft | None) -> float:
    """Of a coil at a level, A m^2; without the satellite the level itself."""
    if craft is None or level == 0:
        return float(level)
    size = craft.levels_am2[min(abs(level), len(craft.levels_am2)) - 1]
    return size if level > 0 else -size
