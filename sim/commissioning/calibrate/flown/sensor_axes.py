"""The wiring of the magnetometer by what does not depend on the attitude: |b|, and its angle to the Sun.

For each of the 48 wirings the offset and the small errors of the sensor are fitted, and the squares of what
the fit leaves are compared. |b| is the same for all of them and gives the offset; s . b is not.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.calibrate.flown.joint_fit import FieldFit, FitPrior, FreeSamples, joint_fit
from sim.commissioning.calibrate.flown.samples import whole
from sim.commissioning.calibrate.flown.wiring import WIRINGS, Wiring, channels_from_body

MATRIX_SIGMA = 0.05
"""Of a component of M about a wiring: scale, non-orthogonality, turn."""
OFFSET_SIGMA_NT = 60000.0
FAR_NT = 4000.0
"""A wiring that leaves so much more rms than the best, before small errors are fitted, is not looked at."""
MOST_SAMPLES = 400
"""That each of the wirings is fitted to."""
LEAST_LIT = 30
OUTLIER = 6.0
"""A sample is left out that lies so many times the scatter off, and the fit made again."""
MEDIAN_CHI2 = 0.455
"""Of one degree of freedom."""
LEAST_CHI2 = 50.0
"""By which a wiring is worse than the best in the sum of squares, and so ruled out."""
LARGEST_SCATTER = 6.0
"""What the best wiring may leave, rms in standard deviations: else none explains the samples."""


class WiringFit(NamedTuple):
    """A wiring that may be, and the fit of the small errors with it."""

    wiring: Wiring
    fit: FieldFit


class SensorAxes(NamedTuple):
    """The wirings that may be, the likeliest first; none, with the reason, where nothing is determined."""

    candidates: tuple[WiringFit, ...]
    reason: str = ""


def sensor_axes(observed: FreeSamples) -> SensorAxes:
    """The wirings of the magnetometer that the samples admit."""
    lit = int(whole(observed.sun).sum())
    if lit < LEAST_LIT:
        return SensorAxes((), f"the Sun was seen in {lit} samples: at least {LEAST_LIT} are needed")
    few = observed.every(max(1, len(observed.field_nt) // MOST_SAMPLES))
    fits = _fits(few)
    kept = without_outliers(fits[0].fit)
    if not kept.all():
        few = few.rows(kept)
        fits = _fits(few)
    scatter2 = fits[0].fit.chi2 / max(1, fits[0].fit.numbers)
    if scatter2 > LARGEST_SCATTER**2:
        return SensorAxes(
            (),
            f"no wiring explains field and Sun: the best leaves {scatter2**0.5:.0f} standard deviations. Is "
            "the orbit right, and the time?",
        )
    limit = fits[0].fit.chi2 + LEAST_CHI2 * max(1.0, scatter2)
    admitted = [one.wiring for one in fits if one.fit.chi2 <= limit]
    return SensorAxes(tuple(WiringFit(wiring, _fit(observed, wiring)) for wiring in admitted))


def without_outliers(fit: FieldFit) -> NDArray[np.bool_]:
    """Samples that lie within ``OUTLIER`` times the scatter of most, by both residuals."""
    scale = np.sqrt(np.nanmedian(fit.residual**2, axis=0) / MEDIAN_CHI2)
    return np.asarray(~(np.abs(fit.residual) > OUTLIER * scale).any(axis=1), bool)


def _fits(observed: FreeSamples) -> list[WiringFit]:
    """Each wiring that comes near, the best first."""
    fits = [WiringFit(wiring, _fit(observed, wiring)) for wiring in _near(observed)]
    return sorted(fits, key=lambda one: one.fit.chi2)


def _fit(observed: FreeSamples, wiring: Wiring) -> FieldFit:
    return joint_fit(observed, FitPrior(channels_from_body(wiring).T, MATRIX_SIGMA, OFFSET_SIGMA_NT))


def _near(observed: FreeSamples) -> list[Wiring]:
    """The wirings that come near without small errors: offset by least squares, s . S^T (z - o) = S . B."""
    lit = whole(observed.sun)
    z, sun, b = observed.field_nt[lit], observed.sun[lit], observed.b_eci_nt[lit]
    along, strength = np.sum(b * observed.sun_eci[lit], axis=1), np.linalg.norm(b, axis=1)
    squares = np.sum(z * z, axis=1)
    of_strength = np.column_stack([z / strength[:, None], -0.5 / strength])
    left = {}
    for wiring in WIRINGS:
        turned = sun @ channels_from_body(wiring).T
        of_angle = np.column_stack([turned, np.zeros(len(z))])
        a = np.vstack([of_strength, of_angle])
        y = np.concatenate([(squares - strength**2) / (2.0 * strength), np.sum(turned * z, axis=1) - along])
        found, *_ = np.linalg.lstsq(a / 1e3, y / 1e3, rcond=1e-9)
        left[wiring] = float(np.sqrt(np.mean((a @ found - y) ** 2)))
    least = min(left.values())
    return [wiring for wiring, rms in left.items() if rms < least + FAR_NT]
