"""What Sun cells should show, which of them Sun and Earth light, and what is the most that they can show."""

from math import hypot
from typing import final

import numpy as np

from fsw.core.algebra.quaternion import Quaternion, rotate
from fsw.core.algebra.vector import Vec3, dot, scale
from fsw.core.estimation.cells.cell_set import SIGMAS, CellSet, Light
from fsw.core.estimation.kalman import Matrix, linear
from fsw.core.estimation.measurement import sun_prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import Parameters

LEAST_COSINE = 0.2
"""Of the angle from a cell's normal to the Sun: below it an attitude error may leave the cell dark."""
BRIGHT = 2.0
"""Times the threshold: a cell that faces away from the Sun is taken if the Earth alone gives it this much."""

CellPrediction = tuple[float, Matrix]
"""What a cell should show without its excess, and the sensitivity, (1, n)."""


@final
class Directions:
    """Sun and Earth as the cells see them, and H of each, (3, n); the Earth's light, relative to the Sun's.

    Misalignment and age are those of the Sun sensor that the cells replace: common to all cells.
    """

    __slots__ = ("e", "e_sensitivity", "earth", "s", "s_sensitivity")

    def __init__(self, s: Vec3, s_sensitivity: Matrix, e: Vec3, e_sensitivity: Matrix, earth: float) -> None:
        self.s = s
        self.s_sensitivity = s_sensitivity
        self.e = e
        self.e_sensitivity = e_sensitivity
        self.earth = earth


def directions(estimate: Estimate, light: Light, config: MekfConfig) -> Directions:
    """Where the cells should see Sun and Earth."""
    q, omega, known = estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters
    s, s_sensitivity = sun_prediction(q, omega, known, light.s_eci, config)
    e, e_sensitivity = sun_prediction(q, omega, known, light.e_eci, config)
    return Directions(s, s_sensitivity, e, e_sensitivity, light.earth)


def prediction(
    estimate: Estimate, cell: int, light: Light, config: MekfConfig, cells: CellSet
) -> CellPrediction:
    """What a cell, clear of the edge of its view, should show, and how that depends on the error state."""
    return shown_by(cell, directions(estimate, light, config), estimate.parameters, config, cells)


def shown_by(
    cell: int, towards: Directions, known: Parameters, config: MekfConfig, cells: CellSet
) -> CellPrediction:
    """As ``prediction``, by the directions that are common to all cells."""
    normal, parts = cells.normals_body[cell], config.layout
    shown, row = 0.0, np.zeros((1, parts.size))
    direct = dot(normal, towards.s)
    if direct > 0.0:
        gain = 1.0 + (known.cell_gain[cell] if known.cell_gain else 0.0)
        shown, row = gain * direct, gain * linear(row, normal, towards.s_sensitivity)
        if parts.cell_gain is not None:
            row[0, parts.cell_gain.start + cell] = direct
    if towards.earth > 0.0:
        view = 0.5 * (1.0 + dot(normal, towards.e))
        of_one = towards.earth / cells.albedo
        earth = towards.earth + of_one * (known.earth_light[0] if known.earth_light else 0.0)
        shown += earth * view * view
        row = linear(row, scale(earth * view, normal), towards.e_sensitivity)
        if parts.earth_light is not None:
            row[0, parts.earth_light.start] = of_one * view * view
    if parts.cells is not None:
        row[0, parts.cells.start + cell] = 1.0
    return shown, row


def sunlit(q_body_from_eci: Quaternion, light: Light, cells: CellSet) -> list[int]:
    """The cells that certainly see the Sun."""
    s = rotate(q_body_from_eci, light.s_eci)
    return [
        cell
        for cell, normal in enumerate(cells.normals_body)
        if dot(normal, s) > LEAST_COSINE and not cells.shaded(cell, s)
    ]


def earthlit(q_body_from_eci: Quaternion, light: Light, cells: CellSet) -> list[int]:
    """The cells that face away from the Sun and that the Earth alone lights."""
    s = rotate(q_body_from_eci, light.s_eci)
    return [
        cell
        for cell, normal in enumerate(cells.normals_body)
        if dot(normal, s) < -LEAST_COSINE and _by_earth(q_body_from_eci, normal, light) > BRIGHT * cells.dark
    ]


def most_behind(estimate: Estimate, normal: Vec3, light: Light, cells: CellSet, within: float = 0.0) -> float:
    """The most that a cell facing away from the Sun can show, by the Earth's light and its excess.

    The Earth is as bright as the table has it, or brighter where the cells together have shown that it is. It
    may be nearer to the normal than estimated: ``within``, by this much of the cosine.
    """
    known = estimate.parameters.earth_light
    brighter = max(0.0, known[0]) / cells.albedo if known and cells.albedo > 0.0 else 0.0
    most = SIGMAS * hypot(cells.excess_sigma, cells.light_sigma)
    return cells.dark + (1.0 + brighter) * _by_earth(estimate.q_body_from_eci, normal, light, within) + most


def _by_earth(q_body_from_eci: Quaternion, normal: Vec3, light: Light, within: float = 0.0) -> float:
    view = 0.5 * (1.0 + min(1.0, dot(normal, rotate(q_body_from_eci, light.e_eci)) + within))
    return light.earth * view * view
