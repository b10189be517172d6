"""Signed permutations of axes: the 48 ways in which three axes can be wired, in numbers and in words."""

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from sim.value_types import Array

Wiring = tuple[int, int, int]
"""By channel or output, the number of the body axis it belongs to, negative for its opposite."""
RIGHT: Wiring = (1, 2, 3)

WIRINGS: tuple[Wiring, ...] = tuple(
    (first * axes[0], second * axes[1], third * axes[2])
    for axes in permutations((1, 2, 3))
    for first, second, third in product((1, -1), repeat=3)
)


def channels_from_body(wiring: Wiring) -> Array:
    """The matrix S that leads body axes to channels: row i is the axis that channel i shows."""
    matrix = np.zeros((3, 3))
    for channel, axis in enumerate(wiring):
        matrix[channel, abs(axis) - 1] = np.sign(axis)
    return matrix


def body_from_outputs(wiring: Wiring) -> Array:
    """The matrix W that leads outputs to body axes: column j is the axis of the coil at output j."""
    return channels_from_body(wiring).T


@dataclass(frozen=True, slots=True)
class WiredUnit:
    """What is wired, how a sentence calls it and its parts, and what a part has to do with an axis."""

    name: str
    part: str
    verb: str
    mirrors: bool


COILS = WiredUnit("coils", "coil", "is along", mirrors=False)
MAGNETOMETER = WiredUnit("magnetometer", "channel", "shows", mirrors=True)


def in_words(unit: WiredUnit, wiring: Wiring) -> str:
    """How a unit is wired, for instance "coils: coil 2 is reversed" or "magnetometer: turned 90 deg ..."."""
    if wiring == RIGHT:
        return f"{unit.name}: wired as the table says"
    turn = _turn(wiring) if unit.mirrors else ""
    if turn:
        return f"{unit.name}: {turn}"
    clauses = [*_swapped(unit, wiring), *_in_turn(unit, wiring)]
    own = [number for number, axis in enumerate(wiring, 1) if axis == -number]
    clauses += [_reversed(unit, own)] if own else []
    clauses += ["its axes are mirrored"] if unit.mirrors else []
    return f"{unit.name}: {'; '.join(clauses)}"


def _reversed(unit: WiredUnit, numbers: list[int]) -> str:
    *others, last = map(str, numbers)
    if not others:
        return f"{unit.part} {last} is reversed"
    return f"{unit.part}s {', '.join(others)} and {last} are reversed"


def _swapped(unit: WiredUnit, wiring: Wiring) -> list[str]:
    """Two that have changed places."""
    found = []
    for one, other in ((1, 2), (1, 3), (2, 3)):
        if abs(wiring[one - 1]) == other and abs(wiring[other - 1]) == one:
            turned = [number for number in (one, other) if wiring[number - 1] < 0]
            text = f"{unit.part}s {one} and {other} are swapped"
            found.append(f"{text}, {_reversed(unit, turned)}" if turned else text)
    return found


def _in_turn(unit: WiredUnit, wiring: Wiring) -> list[str]:
    """All three in another place."""
    if any(abs(wiring[abs(axis) - 1]) == number for number, axis in enumerate(wiring, 1)):
        return []
    return [
        ", ".join(
            f"{unit.part} {number} {unit.verb} axis {'-' if axis < 0 else '+'}{abs(axis)}"
            for number, axis in enumerate(wiring, 1)
        )
    ]


def _turn(wiring: Wiring) -> str:
    """The turn of a sensor whose axes are not mirrored, about an axis of the body; empty for another one."""
    matrix = channels_from_body(wiring)
    if np.linalg.det(matrix) < 0.0:
        return ""
    kept = [number for number in (1, 2, 3) if abs(wiring[number - 1]) == number]
    if len(kept) == 3:
        return f"turned 180 deg about axis {next(n for n in kept if wiring[n - 1] > 0)}"
    if not kept:
        (_, xy, xz), (yx, _, yz), (zx, zy, _) = matrix
        senses = ", ".join("+" if part > 0.0 else "-" for part in (yz - zy, zx - xz, xy - yx))
        return f"turned 120 deg about the diagonal ({senses}) of the axes"
    about = kept[0]
    one, other = (number for number in (1, 2, 3) if number != about)
    if wiring[about - 1] < 0:
        sense = "-" if wiring[one - 1] < 0 else "+"
        return f"turned 180 deg about the diagonal of axes +{one} and {sense}{other}"
    ahead = about % 3 + 1  # a right-handed turn leads this axis to the next
    return f"turned {90 if wiring[ahead - 1] > 0 else -90} deg about axis {about}"
