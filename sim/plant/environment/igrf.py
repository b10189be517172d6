"""The International Geomagnetic Reference Field, Cartesian, regular at the poles, for many points."""

from datetime import UTC, datetime
from importlib.resources import files
from math import factorial, sqrt

import numpy as np
import numpy.typing as npt

from sim.plant.environment.orbit import Array

Complex = npt.NDArray[np.complex128]

REFERENCE_RADIUS_M = 6371.2e3
MAX_DEGREE = 13
_T_PER_NT = 1e-9


class Igrf:
    """IGRF-14, B = -grad V, V = a sum (a/r)^(n+1) (g cos m lambda + h sin m lambda) P_nm(sin phi).

    V is evaluated by Cunningham's recursion in Cartesian coordinates (Cunningham 1970; Montenbruck and
    Gill 2000, eq. 3.27 to 3.33), here with complex Z_nm = V_nm + i W_nm and c = C - i S. Coefficients are
    linear in elapsed days between the models, which are dated 1 January of every fifth year.

    Args:
        degree: highest degree, 1 to 13.

    Raises:
        ValueError: the degree is out of range.
    """

    def __init__(self, degree: int = MAX_DEGREE) -> None:
        if not 1 <= degree <= MAX_DEGREE:
            raise ValueError(f"the degree of the IGRF is 1 to {MAX_DEGREE}, not {degree}")
        self._degree = degree
        years, table = _read_table()
        self._dates_unix_s = np.array([datetime(int(year), 1, 1, tzinfo=UTC).timestamp() for year in years])
        pairs = [(n, m) for n in range(1, degree + 1) for m in range(n + 1)]
        g = np.array([table[n, m] for n, m in pairs])
        h = np.array([table[n, -m] if m else np.zeros(len(years)) for n, m in pairs])
        schmidt = np.array([_schmidt(n, m) for n, m in pairs])
        self._c_nt = schmidt[:, None] * (g - 1j * h)
        self._n, self._m = np.array(pairs).T

    def at(self, unix_s: Array, r_ecef_m: Array) -> Array:
        """The field [T], Earth-fixed axes, (n, 3).

        Args:
            unix_s: times, UTC, shape (n,).
            r_ecef_m: positions, Earth-fixed axes, shape (n, 3).

        Raises:
            ValueError: a time lies outside the years of the table.
        """
        n, m = self._n, self._m
        order = m[:, None]
        harmonics = self._harmonics(r_ecef_m)
        c = self._coefficients(unix_s)
        along = c * harmonics[n + 1, m]
        above = c * harmonics[n + 1, m + 1]
        below = ((n - m + 1) * (n - m + 2))[:, None] * c * harmonics[n + 1, np.maximum(m - 1, 0)]
        above = np.where(order > 0, 0.5 * above, above)
        below = np.where(order > 0, 0.5 * below, 0.0)
        b_x = (above - below).real.sum(axis=0)
        b_y = (above + below).imag.sum(axis=0)
        b_z = ((n - m + 1)[:, None] * along.real).sum(axis=0)
        return _T_PER_NT * np.stack([b_x, b_y, b_z], axis=1)

    def _coefficients(self, unix_s: Array) -> Complex:
        """Coefficients C - i S [nT] for unnormalised functions, (pairs, n)."""
        dates = self._dates_unix_s
        if unix_s.min() < dates[0] or unix_s.max() > dates[-1]:
            first, last = (datetime.fromtimestamp(date, UTC).year for date in (dates[0], dates[-1]))
            raise ValueError(f"the IGRF-14 table covers {first} to {last}; the time asked for lies outside")
        model = np.clip(np.searchsorted(dates, unix_s, side="right") - 1, 0, len(dates) - 2)
        fraction = (unix_s - dates[model]) / (dates[model + 1] - dates[model])
        start, end = self._c_nt[:, model], self._c_nt[:, model + 1]
        c_nt: Complex = start + fraction * (end - start)
        return c_nt

    def _harmonics(self, r_ecef_m: Array) -> Complex:
        """Z_nm = V_nm + i W_nm = (a/r)^(n+1) P_nm e^(i m lambda), (degree + 2, degree + 2, points)."""
        x, y, z = r_ecef_m.T / REFERENCE_RADIUS_M
        rho = 1.0 / (x * x + y * y + z * z)
        sectoral = (x + 1j * y) * rho
        z = z * rho
        size = self._degree + 2
        harmonics: Complex = np.zeros((size, size, len(x)), dtype=np.complex128)
        harmonics[0, 0] = np.sqrt(rho)
        for n in range(1, size):
            m = np.arange(n)[:, None]
            row = (2 * n - 1) * z * harmonics[n - 1, :n]
            if n > 1:
                row -= (n + m - 1) * rho * harmonics[n - 2, :n]
            harmonics[n, :n] = row / (n - m)
            harmonics[n, n] = (2 * n - 1) * sectoral * harmonics[n - 1, n - 1]
        return harmonics


def _schmidt(n: int, m: int) -> float:
    """Schmidt quasi-normalisation of P_nm."""
    return sqrt((2 if m else 1) * factorial(n - m) / factorial(n + m))


def _read_table() -> tuple[list[float], dict[tuple[int, int], Array]]:
    """Years, and by (n, m) the coefficients g (m >= 0) and h (m < 0) [nT] of each year."""
    text = files("sim.plant.environment").joinpath("igrf14.shc").read_text(encoding="ascii")
    _, years, *rows = (line for line in text.splitlines() if not line.startswith("#"))
    table: dict[tuple[int, int], Array] = {}
    for row in rows:
        n, m, *values = row.split()
        table[int(n), int(m)] = np.array([float(value) for value in values])
    return [float(year) for year in years.split()], table
