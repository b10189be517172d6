"""Whether gravity holds a body in its nominal attitude, and in which one it would.

A body that turns with its orbit rests where its principal axes are those of the orbit. Small turns about
axis 1 (up), 2 (ahead) and 3 (the orbit's normal) from there are turned back by

    k1 = w0^2 (J3 - J2) + w0 h3,    k2 = 4 w0^2 (J3 - J1) + w0 h3,    k3 = 3 w0^2 (J2 - J1)

per radian, h3 being the momentum of wheels about axis 3: gravity's torque and that of the turn with the
orbit (Hughes 1986, Spacecraft Attitude Dynamics, sections 9.2 and 9.3). Damping needs all three: the least
moment up, the largest along the normal. Where one is negative the body turns away, with k sin(2 d) / 2 at a
turn d, and the coils have to hold it all the time. About axis 1 they do, as it is the gyroscopic torque alone
and a weak one; with k2 or k3 negative two of three flights that began at 40 deg fell over (docs/sizing.md).
"""

from dataclasses import dataclass

import numpy as np

from sim.design.from_scenario import body_of
from sim.design.theory.bodies import Body
from sim.design.theory.linear import resting_torque
from sim.scenario.controlled import controlled
from sim.scenario.schema import Scenario
from sim.sizing.expectation import field_across

SLIGHT = 0.25
"""Part of what coils give in the mean up to which products of inertia are another disturbance."""
NEUTRAL = 0.01
"""Part of the largest moment by which two may differ and count as equal: nothing turns the body then."""
UP, AHEAD, NORMAL = range(3)
NAMES = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Gravity:
    """What gravity does to a body in its nominal attitude, about the axes that matter to what is controlled.

    Attributes:
        moments_kgm2: about the axes 1, 2, 3 of the laws.
        names: of the body axes that these are.
        free: the axes, 0 to 2, about which nothing turns it.
        away: those about which gravity turns it away.
        away_nm: the most with which it does, about any of them.
        resting_nm: with which it acts on the body at rest in that attitude, by its products of inertia,
            and its wheels.
        coils_nm: what its coils give in the mean, about an axis across the field.
    """

    moments_kgm2: tuple[float, float, float]
    names: tuple[str, str, str]
    free: tuple[int, ...]
    away: tuple[int, ...]
    away_nm: float
    resting_nm: float
    coils_nm: float

    @property
    def rests_elsewhere(self) -> bool:
        """Whether the nominal attitude is none of rest: the coils would have to hold it there."""
        return self.resting_nm > SLIGHT * self.coils_nm

    @property
    def falls_over(self) -> bool:
        """Whether the coils can hardly hold it: it is gravity's own torque that turns it away."""
        return AHEAD in self.away or NORMAL in self.away

    @property
    def held_order(self) -> tuple[int, int, int]:
        """The axes of the laws, 0 to 2, that gravity would hold up, ahead and along the normal."""
        least, middle, largest = sorted(range(3), key=lambda axis: self.moments_kgm2[axis])
        return least, middle, largest


def gravity_on(scenario: Scenario) -> Gravity:
    """What gravity does to the satellite of a scenario."""
    body, coils, what = body_of(scenario), scenario.coils, controlled(scenario).what
    matter = {"attitude": (UP, AHEAD, NORMAL), "axis": (AHEAD, NORMAL)}.get(what, ())
    if scenario.control.spin_radps != 0.0:
        matter = ()
    about, neutral_nm = stiffness(body), neutral(body)
    away = tuple(axis for axis in turned_away(body) if axis in matter)
    return Gravity(
        moments_of(body),
        names=names_of(scenario),
        free=tuple(axis for axis in matter if abs(about[axis]) <= neutral_nm),
        away=away,
        away_nm=max((-0.5 * about[axis] for axis in away), default=0.0),
        resting_nm=float(np.linalg.norm(resting_torque(body))) if matter else 0.0,
        coils_nm=coils.on_part * coils.largest_am2 * field_across(body),
    )


def names_of(scenario: Scenario) -> tuple[str, str, str]:
    """The body axes that are axes 1, 2, 3 of the laws."""
    axes = scenario.body.law_axes
    first, second, third = (0, 1, 2) if axes is None else axes.place
    return NAMES[first], NAMES[second], NAMES[third]


def moments_of(body: Body) -> tuple[float, float, float]:
    """The moments about axes 1, 2, 3: the diagonal of the tensor."""
    first, second, third = body.inertia_kgm2
    return first[0], second[1], third[2]


def stiffness(body: Body) -> tuple[float, float, float]:
    """k1, k2, k3, per radian [N m]."""
    j1, j2, j3 = moments_of(body)
    square, gyroscopic = body.rate_radps**2, body.rate_radps * body.wheel_nms[2]
    return square * (j3 - j2) + gyroscopic, 4.0 * square * (j3 - j1) + gyroscopic, 3.0 * square * (j2 - j1)


def neutral(body: Body) -> float:
    """Up to this stiffness, per radian [N m], nothing turns the body about an axis."""
    return NEUTRAL * body.rate_radps**2 * max(moments_of(body))


def turned_away(body: Body) -> tuple[int, ...]:
    """The axes, 0 to 2, about which gravity turns the body away."""
    return tuple(axis for axis, k in enumerate(stiffness(body)) if k < -neutral(body))


def gravity_words(gravity: Gravity) -> str:
    """What it does in the nominal attitude, and which one to choose where it does not hold it."""
    words = gravity_predicate(gravity)
    if gravity.rests_elsewhere:
        return f"{words}: choose body axes along the principal ones"
    return f"{words}: {turn_needed(gravity)}" if gravity.away else words


def gravity_predicate(gravity: Gravity) -> str:
    """Whether it holds the nominal attitude, turns the body away or leaves it free."""
    if gravity.rests_elsewhere:
        return (
            "does not let the body rest in its nominal attitude: by its products of inertia and its wheels "
            f"it takes {gravity.resting_nm:.2g} N m, {gravity.resting_nm / gravity.coils_nm:.0%} of what the "
            "coils give in the mean, to hold it there"
        )
    if not gravity.away:
        return f"holds the body{f', but for turns about {_axes(gravity.free)}' if gravity.free else ''}"
    how = (
        f"about {_axes(gravity.away)}, with up to {gravity.away_nm:.2g} N m, "
        f"{gravity.away_nm / gravity.coils_nm:.0%} of what the coils give in the mean"
    )
    if gravity.falls_over:
        return f"turns the body over {how}"
    return f"turns the body away {how}, so that these have to hold it all the time"


def turn_needed(gravity: Gravity) -> str:
    """Which attitude gravity holds, and how to choose it, as clauses."""
    up, ahead, normal = (gravity.names[axis] for axis in gravity.held_order)
    return (
        f"it would hold {up}, of the least moment, up and {normal}, of the largest, along the orbit's "
        f"normal; for that attitude set body.up = '{up}' and body.ahead = '{ahead}'"
    )


def _axes(axes: tuple[int, ...]) -> str:
    *first, last = (str(axis + 1) for axis in axes)
    return f"axes {', '.join(first)} and {last}" if first else f"axis {last}"
