"""Where a filter without gyros starts: spins about a known axis that carry the field as it was measured.

The samples are turned back to the first one about the axis, at each rate of a grid, and the attitude then is
that which fits all of them best (Wahba 1965; Markley 1988). A field that moves little in space fits two
spins, one in each sense of the cone that it draws. Both are found; what is not the field tells them apart.
"""

from collections.abc import Sequence
from math import ceil, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sim.commissioning.recorded.strays import MOST_ROUNDS, stray_sizes, stray_values
from sim.value_types import Array

COARSE_S = 60.0
"""Part of the pass from which the rate is found first."""
AROUND_DEGPS, STEP_DEGPS = 1.0, 0.01
"""The grid around that rate on which spins are sought."""
MOST_SPINS = 3
"""Spins that are followed."""
WORSE, LEAST_DEG = 2.5, 2.0
"""A spin is considered if its misfit is at most ``WORSE`` times the best one's plus ``LEAST_DEG``."""
LEAST_NT = 1e-6
"""A sample without a direction counts for nothing."""
CHUNK = 64
"""Rates whose rotations are held in memory at once."""


class Spin(NamedTuple):
    """A start of the filter.

    Attributes:
        rate_degps: about the axis.
        misfit_deg: RMS angle between the samples and the field.
        dcm_body_from_eci: attitude at the first sample, (3, 3).
        omega_body_radps: rate, body axes.
        bias_nt: what remains of the bias across the axis, body axes.
    """

    rate_degps: float
    misfit_deg: float
    dcm_body_from_eci: Array
    omega_body_radps: Array
    bias_nt: Array


def spins(t_s: Array, field_nt: Array, b_eci_nt: Array, axis: Array, hertz: float = 1.0) -> list[Spin]:
    """The spins that fit a stretch of samples, the best first.

    Args:
        t_s: times of the samples, (n).
        field_nt: calibrated field, body axes, (n, 3).
        b_eci_nt: field along the orbit, (n, 3).
        axis: of the spin, body axes, unit.
        hertz: rate of the samples, beyond half of which rates look like others.
    """
    t_s = t_s - t_s[0]
    first = t_s <= COARSE_S
    step = 90.0 / max(float(t_s[first][-1]), 1.0) / 4.0
    grid = np.arange(-180.0 * hertz, 180.0 * hertz, min(step, 0.5))
    mean = field_nt[first].mean(axis=0)
    tries = (np.zeros(3), mean - (mean @ axis) * axis)  # a bias stands still, and so may the field
    misfits = [_fits(t_s[first], field_nt[first] - bias, b_eci_nt[first], axis, grid)[0] for bias in tries]
    coarse = float(grid[np.argmin(min(misfits, key=np.min))])
    bias_nt = _bias_across(t_s, field_nt, axis, coarse)
    grid = np.arange(coarse - AROUND_DEGPS, coarse + AROUND_DEGPS, STEP_DEGPS)
    misfit, attitudes = _fits(t_s, field_nt - bias_nt, b_eci_nt, axis, grid)
    inner = range(1, len(grid) - 1)
    least = [n for n in inner if misfit[n] < misfit[n - 1] and misfit[n] <= misfit[n + 1]]
    least.sort(key=lambda n: float(misfit[n]))
    if not least:
        least = [int(np.argmin(misfit))]
    worst = WORSE * float(misfit[least[0]]) + LEAST_DEG
    return [
        Spin(float(grid[n]), float(misfit[n]), attitudes[n], radians(float(grid[n])) * axis, bias_nt)
        for n in least[:MOST_SPINS]
        if misfit[n] <= worst
    ]


def _bias_across(t_s: Array, field_nt: Array, axis: Array, rate_degps: float) -> Array:
    """The constant part of the samples across the axis, beside one that turns at about this rate.

    The field along the axis is constant too, so that along it nothing is found. The turning part may change
    in size, and the rate be a little off: both are taken as polynomials of time.
    """
    if abs(rate_degps) * float(t_s[-1]) < 360.0:
        return np.zeros(3)
    phase = np.radians(rate_degps) * t_s
    late = t_s / t_s[-1]
    turning = np.column_stack((np.cos(phase), np.sin(phase)))
    columns = np.column_stack(
        (np.ones_like(t_s), turning, turning * late[:, None], turning * late[:, None] ** 2)
    )
    constant: Array = np.linalg.lstsq(columns, field_nt, rcond=None)[0][0]
    return constant - (constant @ axis) * axis


def _fits(
    t_s: Array, field_nt: Array, b_eci_nt: Array, axis: Array, rates_degps: Array
) -> tuple[Array, Array]:
    """RMS misfit, deg, and attitude at time 0 of the best fit at each rate, (k) and (k, 3, 3)."""
    body = field_nt / np.maximum(np.linalg.norm(field_nt, axis=1), LEAST_NT)[:, None]
    space = b_eci_nt / np.linalg.norm(b_eci_nt, axis=1)[:, None]
    cross = np.cross(axis, body)
    along = np.outer(body @ axis, axis)
    profiles = []
    for chunk in np.array_split(rates_degps, ceil(len(rates_degps) / CHUNK)):
        angle = np.radians(np.outer(chunk, t_s))
        # turned back to time 0: v cos a + (axis x v) sin a + axis (axis . v) (1 - cos a)
        profiles.append(
            np.einsum("kn,ni,nj->kij", np.cos(angle), body - along, space, optimize=True)
            + np.einsum("kn,ni,nj->kij", np.sin(angle), cross, space, optimize=True)
            + np.einsum("ni,nj->ij", along, space)
        )
    u, s, vt = np.linalg.svd(np.concatenate(profiles))
    sign = np.linalg.det(u @ vt)
    u[:, :, 2] *= sign[:, None]
    gain = (s[:, 0] + s[:, 1] + sign * s[:, 2]) / len(t_s)
    misfit: Array = np.degrees(np.sqrt(np.maximum(0.0, 2.0 * (1.0 - gain))))
    return misfit, u @ vt


def in_words(found: Sequence[Spin]) -> str:
    """The rates of spins, for people."""
    return " and ".join(f"{one.rate_degps:.2f} deg/s" for one in found)


def spin_axis(field_nt: Array) -> Array:
    """The axis across which samples in a row differ: that of a steady spin, body axes, its largest part > 0.

    Differences of a turning vector lie across the rate; the least of their squares is along it. Differences
    that are far out of that plane, as beside a sample that is wrong, are left out.
    """
    steps = np.diff(field_nt, axis=0)
    axis: Array = np.linalg.eigh(steps.T @ steps)[1][:, 0]
    strays = stray_values(steps @ axis)
    for _ in range(MOST_ROUNDS):
        axis = np.linalg.eigh(steps[~strays].T @ steps[~strays])[1][:, 0]
        before, strays = strays, stray_values(steps @ axis)
        if np.array_equal(before, strays):
            break
    return axis * float(np.copysign(1.0, axis[np.argmax(np.abs(axis))]))


def stray_directions(
    t_s: Array, field_nt: Array, b_eci_nt: Array, axis: Array, spin: Spin
) -> NDArray[np.bool_]:
    """Which samples of a stretch, (n), point far from where a spin about an axis has the field."""
    turned_back = Rotation.from_rotvec(np.outer(np.radians(spin.rate_degps) * (t_s - t_s[0]), axis))
    body = turned_back.apply(field_nt - spin.bias_nt)
    return stray_sizes(misfit_deg(body, b_eci_nt @ spin.dcm_body_from_eci.T))


def misfit_deg(body: Array, predicted: Array) -> Array:
    """Angles between directions row by row, deg."""
    cosine = (
        np.sum(body * predicted, axis=1) / np.linalg.norm(body, axis=1) / np.linalg.norm(predicted, axis=1)
    )
    angles: Array = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return angles
