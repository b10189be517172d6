"""The IGRF-14 geomagnetic field in Earth-fixed Cartesian coordinates, without a singularity at the poles.

With the reference radius a and r = |r|, the potential is a sum over degree n and order m (Schmidt
semi-normalised g, h in nT) and the field its negative gradient:

    V = a sum_nm S_nm (g_nm V_nm + h_nm W_nm),   V_nm + i W_nm = (a/r)^(n+1) P_nm(sin lat) e^(i m lon)

The derivatives of V_nm and W_nm are V and W of degree n + 1 and orders m - 1, m, m + 1 (Cunningham 1970;
Montenbruck and Gill 2000, eqs 3.29 to 3.33), so that the field itself is one sum over V and W, whose
coefficients are gathered once. V and W are computed in a scaling where each column of one order obeys the
monic recursion U_n+1 = z U_n - f rho U_n-1; every normalisation is in the gathered coefficients.
"""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from math import factorial, sqrt
from typing import Final

from fsw.core.algebra.vector import Vec3
from fsw.core.orbit.igrf_coefficients import COEFFICIENTS_NT, EPOCHS_UNIX_S, MAX_DEGREE

REFERENCE_RADIUS_M: Final = 6371200.0

Gauss = Mapping[tuple[int, int], float]
"""Coefficients by (n, m): g(n, m) for m >= 0, h(n, -m) for m < 0, in nT."""

Term = tuple[float, float, float, float, float, float, float]
Harmonics = tuple[tuple[Term, ...], ...]
"""Columns of one order; a term is f of the next degree, then the factors of V and W in Bx, By, Bz, in T."""


@dataclass(frozen=True, slots=True)
class FieldModel:
    """The field at an epoch and its secular variation per second."""

    epoch_unix_s: float
    at_epoch: Harmonics
    per_s: Harmonics


def prepare(epoch_unix_s: float, degree: int = MAX_DEGREE) -> FieldModel:
    """The field model of a flight that begins at the epoch.

    Each coefficient is linear in elapsed time between the five-year models; the slope at the epoch holds
    for the whole flight.

    Raises:
        ValueError: the epoch is outside 2015 to 2030, or the degree outside 1 to ``MAX_DEGREE``.
    """
    if not 1 <= degree <= MAX_DEGREE:
        raise ValueError(f"the onboard field has degrees 1 to {MAX_DEGREE}, not {degree}")
    if not EPOCHS_UNIX_S[0] <= epoch_unix_s <= EPOCHS_UNIX_S[-1]:
        raise ValueError(f"IGRF-14 holds from 2015 to 2030, not at Unix time {epoch_unix_s:.0f} s")
    segment = min(bisect_right(EPOCHS_UNIX_S, epoch_unix_s), len(EPOCHS_UNIX_S) - 1)
    start_s, end_s = EPOCHS_UNIX_S[segment - 1], EPOCHS_UNIX_S[segment]
    value: dict[tuple[int, int], float] = {}
    slope: dict[tuple[int, int], float] = {}
    for n, m, *by_epoch in COEFFICIENTS_NT:
        before, after = by_epoch[segment - 1], by_epoch[segment]
        slope[n, m] = (after - before) / (end_s - start_s)
        value[n, m] = before + slope[n, m] * (epoch_unix_s - start_s)
    return FieldModel(epoch_unix_s, harmonics(value, degree), harmonics(slope, degree))


def field_ecef_t(r_ecef_m: Vec3, unix_s: float, model: FieldModel) -> Vec3:
    """B at a place (m, ECEF) and time: (3,) in T, ECEF."""
    b1, b2, b3 = gradient(r_ecef_m, model.at_epoch)
    d1, d2, d3 = gradient(r_ecef_m, model.per_s)
    elapsed_s = unix_s - model.epoch_unix_s
    return (b1 + elapsed_s * d1, b2 + elapsed_s * d2, b3 + elapsed_s * d3)


def gradient(r_ecef_m: Vec3, columns: Harmonics) -> Vec3:
    """-grad V of one set of harmonics at a place (m, ECEF): (3,) in T, or T/s for a secular variation.

    Raises:
        ZeroDivisionError: the place is the centre of the Earth.
    """
    x, y, z = r_ecef_m
    factor = REFERENCE_RADIUS_M / (x * x + y * y + z * z)
    rho = REFERENCE_RADIUS_M * factor
    x, y, z = factor * x, factor * y, factor * z
    seed_v, seed_w = sqrt(rho), 0.0
    b1 = b2 = b3 = 0.0
    for column in columns:
        v, w = seed_v, seed_w
        v_below = w_below = 0.0
        for f, x_v, x_w, y_v, y_w, z_v, z_w in column:
            b1 += x_v * v + x_w * w
            b2 += y_v * v + y_w * w
            b3 += z_v * v + z_w * w
            f_rho = f * rho
            v, v_below = z * v - f_rho * v_below, v
            w, w_below = z * w - f_rho * w_below, w
        seed_v, seed_w = x * seed_v - y * seed_w, x * seed_w + y * seed_v
    return (b1, b2, b3)


def harmonics(gauss_nt: Gauss, degree: int) -> Harmonics:
    """The gathered coefficients of the field of a potential, complete to the degree."""
    return tuple(tuple(_term(gauss_nt, n, m) for n in range(m, degree + 2)) for m in range(degree + 2))


def _term(gauss_nt: Gauss, n: int, m: int) -> Term:
    """The term of V and W of degree n and order m: the potential's terms of degree n - 1 reach it."""
    g_west, h_west = _unnormalised_t(gauss_nt, n - 1, m - 1)
    g, h = _unnormalised_t(gauss_nt, n - 1, m)
    g_east, h_east = _unnormalised_t(gauss_nt, n - 1, m + 1)
    to_west = _scaling(n, m) * (1.0 if m == 1 else 0.5)
    straight = _scaling(n, m) * (n - m)
    to_east = _scaling(n, m) * 0.5 * (n - m) * (n - m - 1)
    return (
        (n + m) * (n - m) / ((2 * n + 1) * (2 * n - 1)),
        to_west * g_west - to_east * g_east,
        to_west * h_west - to_east * h_east,
        -to_west * h_west - to_east * h_east,
        to_west * g_west + to_east * g_east,
        straight * g,
        straight * h,
    )


def _unnormalised_t(gauss_nt: Gauss, n: int, m: int) -> tuple[float, float]:
    """Coefficients g and h for unnormalised associated Legendre functions, in T; zero without such a term."""
    if not 0 <= m <= n or n == 0:
        return (0.0, 0.0)
    schmidt = sqrt((1 if m == 0 else 2) * factorial(n - m) / factorial(n + m)) * 1e-9
    return (schmidt * gauss_nt[n, m], schmidt * gauss_nt[n, -m] if m > 0 else 0.0)


def _scaling(n: int, m: int) -> float:
    """V_nm over its monic form: (2n - 1)!! / (n - m)!."""
    odd = 1
    for factor in range(1, 2 * n, 2):
        odd *= factor
    return odd / factorial(n - m)
