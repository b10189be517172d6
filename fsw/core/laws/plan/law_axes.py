"""The axes that the laws count by: 1 looks up, 2 flies ahead, 3 points along the orbit's normal.

They are body axes, renumbered: one of the 24 turns that carry axes onto axes. Sensors, estimate and
telemetry stay in the body axes that the satellite's builders gave it.
"""

from dataclasses import dataclass
from typing import Final, final

from fsw.core.algebra.quaternion import IDENTITY, Quaternion, canonical, from_dcm, multiply
from fsw.core.algebra.vector import Mat3, Vec3, cross
from fsw.core.estimation.attitude import Attitude

NAMED: Final[dict[str, Vec3]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Unit vectors along the body axes and against them, by name."""


@final
@dataclass(frozen=True, slots=True)
class LawAxes:
    """Which body axis is each axis of the laws, and the turn between them.

    Attributes:
        place: by law axis, the number of its body axis, 0 to 2.
        sign: by law axis, 1 along that body axis, -1 against it.
        q_law_from_body: the turn, v_law = C(q) v_body.
    """

    place: tuple[int, int, int]
    sign: tuple[int, int, int]
    q_law_from_body: Quaternion

    def of_body(self, v_body: Vec3) -> Vec3:
        """A vector in the axes of the laws."""
        (a, b, c), (p, q, r) = self.place, self.sign
        return (p * v_body[a], q * v_body[b], r * v_body[c])

    def to_body(self, v_law: Vec3) -> Vec3:
        """A vector of the laws in body axes."""
        turned = [0.0, 0.0, 0.0]
        for part, place, sign in zip(v_law, self.place, self.sign, strict=True):
            turned[place] = sign * part
        return (turned[0], turned[1], turned[2])

    def matrix(self, of_body: Mat3) -> Mat3:
        """P M P^T of a matrix M by body axes in rows and columns, P the turn to the axes of the laws.

        So a tensor of inertia is turned, and by rows the dipole of each coil per unit nominal one.
        """
        (a, b, c), (p, q, r) = self.place, self.sign
        a1, a2, a3 = self.of_body(of_body[a])
        b1, b2, b3 = self.of_body(of_body[b])
        c1, c2, c3 = self.of_body(of_body[c])
        return (p * a1, p * a2, p * a3), (q * b1, q * b2, q * b3), (r * c1, r * c2, r * c3)

    def attitude(self, of_body: Attitude) -> Attitude:
        """The attitude of these axes relative to the orbital frame, as certain as that of the body."""
        return Attitude(
            canonical(multiply(of_body.q_body_from_orbit, self.q_law_from_body)),
            self.of_body(of_body.omega_body_orbit_radps),
            of_body.sigma3_attitude_rad,
            of_body.sigma3_rate_radps,
            of_body.valid,
            of_body.usable,
        )


def law_axes(up: str, ahead: str) -> LawAxes | None:
    """The axes of the laws by the names of the body axes that look up and fly ahead; None: they are the same.

    Raises:
        ValueError: the two are not at right angles.
    """
    first, second = NAMED[up], NAMED[ahead]
    third = cross(first, second)
    if third == (0.0, 0.0, 0.0):
        raise ValueError(f"{ahead!r} cannot fly ahead where {up!r} looks up: choose an axis across it")
    q_law_from_body = from_dcm((first, second, third))
    if q_law_from_body == IDENTITY:
        return None
    places, signs = [], []
    for row in (first, second, third):
        place = 0 if row[0] != 0.0 else 1 if row[1] != 0.0 else 2
        places.append(place)
        signs.append(int(row[place]))
    return LawAxes((places[0], places[1], places[2]), (signs[0], signs[1], signs[2]), q_law_from_body)
