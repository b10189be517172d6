"""Field and cells, linear about an estimate, and what a correction of the estimate leaves as it is.

A sample is z = h(x) + s: s is the bias of the field or the excess of a cell, x the rest of the error state.
After a few samples h + s is known to their noise, while x and s are not: the covariance is thin across h + s.
A correction that moves x far changes H = dh/dx. The same covariance, read with the new H, is thin along
another direction; the next sample cuts it at an angle, and seems to show x, which it does not. A little is
gained in each tick, and the filter becomes sure of a wrong rotation about the field.

With h + s in place of s a sample is linear, and no correction changes what it tells. So, with d the
correction from x_0 to x_1,

    s <- s + h(x_0) + H_0 d - h(x_1),    P <- T P T^T,  T = 1 + E (H_0 - H_1),

E being the place of s in the error state: value and covariance of h + s stay as the linear equations had
them.

Source: errors in coordinates in which samples are linear, Barrau, Bonnabel 2017; filters that gain
information because H changes, Huang, Mourikis, Roumeliotis 2010.
"""

from math import nan
from typing import final

import numpy as np

from fsw.core.algebra.quaternion import conjugate, multiply
from fsw.core.algebra.vector import Vec3, sub
from fsw.core.estimation.cells.cell_set import CellSet, Light
from fsw.core.estimation.cells.prediction import directions, earthlit, shown_by, sunlit
from fsw.core.estimation.kalman import Matrix, diagonal, product, shear
from fsw.core.estimation.measurement import field_prediction
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.estimation.parameters import correct_parameters, difference


@final
class Linear:
    """Field and lit cells about an estimate: what they show without bias and excess, and H.

    ``about``: a copy of the estimate. ``by_sun``, ``by_earth``: numbers of the cells that each lights.
    ``values`` (3 + k) and ``rows`` (3 + k, n): of the field, T, and of these k cells in this order; the rows
    include bias and excess.
    """

    __slots__ = ("about", "b_eci_t", "by_earth", "by_sun", "light", "rows", "values")

    def __init__(
        self,
        about: Estimate,
        b_eci_t: Vec3,
        light: Light | None,
        by_sun: tuple[int, ...],
        by_earth: tuple[int, ...],
        values: Matrix,
        rows: Matrix,
    ) -> None:
        self.about = about
        self.b_eci_t = b_eci_t
        self.light = light
        self.by_sun = by_sun
        self.by_earth = by_earth
        self.values = values
        self.rows = rows


def linear_about(
    estimate: Estimate, b_eci_t: Vec3, light: Light | None, config: MekfConfig, cells: CellSet
) -> Linear:
    """The linear equations of a tick.

    Args:
        estimate: predicted to this tick.
        b_eci_t: field as modelled, where it was sampled.
        light: the light; None: no cell is lit.
        config: the filter.
        cells: the cells.
    """
    q = estimate.q_body_from_eci
    by_sun, by_earth = (sunlit(q, light, cells), earthlit(q, light, cells)) if light else ([], [])
    values, rows = _shown(estimate, b_eci_t, light, (*by_sun, *by_earth), config, cells)
    return Linear(estimate.copy(), b_eci_t, light, tuple(by_sun), tuple(by_earth), values, rows)


def _shown(
    estimate: Estimate,
    b_eci_t: Vec3,
    light: Light | None,
    lit: tuple[int, ...],
    config: MekfConfig,
    cells: CellSet,
) -> tuple[Matrix, Matrix]:
    field, field_rows = field_prediction(
        estimate.q_body_from_eci, estimate.omega_body_radps, estimate.parameters, b_eci_t, config
    )
    values, rows = list(sub(field, estimate.parameters.mag_bias_t)), [field_rows]
    if light is not None and lit:
        towards = directions(estimate, light, config)
        for cell in lit:
            value, row = shown_by(cell, towards, estimate.parameters, config, cells)
            values.append(value)
            rows.append(row)
    return np.array(values), np.concatenate(rows)


def cell_shown(known: Linear, number: int, estimate: Estimate, config: MekfConfig) -> tuple[float, Matrix]:
    """What a cell shows at an estimate nearby, by the linear equations; and H, (1, n).

    ``number``: its place among the lit ones.
    """
    cell, row = (*known.by_sun, *known.by_earth)[number], known.rows[3 + number]
    about = float(known.values[3 + number]) + known.about.parameters.cell_excess[cell]
    moved = correction(known.about, estimate, config)
    return about + float(product(row[None, :], moved[:, None])[0, 0]), row[None, :]


def relinearise(
    estimate: Estimate, known: Linear, config: MekfConfig, cells: CellSet, frozen: bool = False
) -> None:
    """Let bias and excesses take up what the linear equations have left out.

    Those that are certain do not, nor any while the parameters are ``frozen``.

    Args:
        estimate: corrected by the samples of the tick.
        known: the equations by which it was.
        config: the filter.
        cells: the cells.
        frozen: whether the parameters keep their values.
    """
    lit = (*known.by_sun, *known.by_earth)
    numbers, places = _uncertain(estimate, lit, config)
    if not places or frozen:
        return
    values, rows = _shown(estimate, known.b_eci_t, known.light, lit, config, cells)
    moved = correction(known.about, estimate, config)
    left = np.zeros(len(moved))
    left[places] = (known.values - values + product(known.rows, moved[:, None])[:, 0])[numbers] - moved[
        places
    ]
    change = (known.rows - rows)[numbers]
    estimate.covariance = shear(estimate.covariance, change, tuple(places))
    if estimate.trace is not None:
        effect = estimate.trace.effect.copy()
        effect[places] += product(change, effect)
        estimate.trace.effect = effect
    correct_parameters(estimate.parameters, tuple(left.tolist()), config.layout)


def correction(before: Estimate, after: Estimate, config: MekfConfig) -> Matrix:
    """What was added to the error state, (n)."""
    scalar, x, y, z = multiply(conjugate(before.q_body_from_eci), after.q_body_from_eci)
    twice = 2.0 / (scalar or nan)  # 0 of damaged numbers alone
    rate = sub(after.omega_body_radps, before.omega_body_radps)
    known = difference(before.parameters, after.parameters, config.layout)
    return np.array((twice * x, twice * y, twice * z, *rate, *known))


def _uncertain(estimate: Estimate, lit: tuple[int, ...], config: MekfConfig) -> tuple[list[int], list[int]]:
    """Of field and lit cells, those whose bias or excess is uncertain: numbers, and places of it."""
    parts, variances = config.layout, diagonal(estimate.covariance)
    place_of: dict[int, int] = {}
    if parts.mag_bias is not None:
        place_of = {axis: parts.mag_bias.start + axis for axis in range(3)}
    if parts.cells is not None:
        place_of |= {3 + number: parts.cells.start + cell for number, cell in enumerate(lit)}
    uncertain = {number: place for number, place in place_of.items() if variances[place] > 0.0}
    return list(uncertain), list(uncertain.values())
