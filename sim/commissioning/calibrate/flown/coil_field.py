"""The coils' field on the magnetometer, and how late a sample shows it, from the pulses of a log.

Around each pulse the reading of a channel is a cubic in time, the Earth's field as the body turns, plus the
response of the output that is driven:

    z(k) = p3(k) + D_j m(k - d),   m(k - d) linear between ticks

m(k) the dipole driven over the tick that ended at k, d the delay. D is linear, and found for each d on a grid
by least squares; d is where the squares are least.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim.commissioning.calibrate.flown.samples import Samples, whole
from sim.value_types import Array, Numbers

AROUND_S = 12
"""Time before and after a pulse that shows the field without it."""
LONGEST_DELAY_S = 4
"""And half of the shortest pause between pulses at most, so that each shows by itself. A delay at the end of
the grid may be any longer one, and is not determined."""
STEP_S, MOST_STEP = 0.02, 0.2
"""Of the grid of delays, s, and at most so many ticks."""
CUBIC = 4
DETECTED_SIGMAS = 6.0
"""A delay is known where the response is above so many of its standard deviations."""


@dataclass(frozen=True, slots=True)
class CoilResponse:
    """Response of the channels to the outputs of the coil driver.

    Attributes:
        nt_per_am2: column j is the response to a nominal 1 A m^2 of output j, channels of the magnetometer.
        sigma: its standard deviations.
        pulses: of each output.
        delay_ticks, delay_sigma: how late it shows; None where no response is seen, or it comes too late.
        noise_nt: standard deviation of a reading about the fit.
        residual_nt, residual_phase: what the fit leaves, and the ticks since the pulse's request.
    """

    nt_per_am2: Array
    sigma: Array
    pulses: tuple[int, int, int]
    delay_ticks: float | None
    delay_sigma: float | None
    noise_nt: float
    residual_nt: Array
    residual_phase: Array


@dataclass(frozen=True, slots=True)
class _Window:
    """One pulse: its output, the readings about their cubic, and what takes a cubic off a drive."""

    output: int
    rows: Numbers
    begin: int
    readings: Array
    cubics: Array
    """Orthonormal, (rows, 4)."""

    def without_cubic(self, values: Array) -> Array:
        """What is no cubic of values at its rows."""
        left: Array = values - self.cubics @ (self.cubics.T @ values)
        return left


def coil_response(samples: Samples, levels_am2: tuple[float, float, float]) -> CoilResponse:
    """The response to the pulses of a log.

    Args:
        samples: of the log.
        levels_am2: nominal dipoles of levels 1, 2, 3.
    """
    driven = np.zeros((len(samples), 3))
    dipoles = np.array([0.0, *levels_am2])[np.abs(samples.level)] * np.sign(samples.level)
    driven[np.arange(len(samples)), np.clip(samples.coil, 0, 2)] = dipoles
    runs = _runs(np.any(driven != 0.0, axis=1) | ~samples.reported)
    pulses = [(begin, end) for begin, end in runs if driven[begin:end].any()]
    longest = _longest_delay(pulses, samples)
    windows = _windows(samples, driven, runs, longest)
    step = min(STEP_S * samples.tick_hz, MOST_STEP)
    delays = np.arange(0.0, longest + 0.5 * step, step)
    fits = [_at_delay(windows, driven, delay) for delay in delays.tolist()]
    costs = np.array([fit.cost for fit in fits])
    best = int(np.argmin(costs)) if windows else 0
    fit = fits[best]
    numbers = sum(3 * len(window.rows) for window in windows)
    free = numbers - sum(3 * CUBIC for _ in windows) - 10
    noise = float(np.sqrt(fit.cost / free)) if free > 0 else float("inf")
    sigma = noise / np.sqrt(np.maximum(fit.weight, 1e-300))[None, :] * np.ones((3, 1))
    seen = bool((np.abs(fit.response) > DETECTED_SIGMAS * sigma).any()) and free > 0
    known = seen and best < len(delays) - 1
    delay, delay_sigma = _refined(delays, costs, best, noise) if known else (None, None)
    residual, phase = _residuals(windows, driven, fit, delays[best])
    counts = [sum(window.output == output for window in windows) for output in range(3)]
    return CoilResponse(
        fit.response, sigma, (counts[0], counts[1], counts[2]), delay, delay_sigma, noise, residual, phase
    )


@dataclass(frozen=True, slots=True)
class _Fit:
    response: Array
    weight: Array
    cost: float


def _runs(on: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First tick of each run of ticks that are on, and the one after its last.

    A run is a pulse, pulses without a pause between them, or ticks in which a coil may have been driven.
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on.astype(int), [0]])))
    return list(zip(edges[0::2].tolist(), edges[1::2].tolist(), strict=True))


def _longest_delay(runs: list[tuple[int, int]], samples: Samples) -> int:
    """Of the grid, ticks."""
    pauses = [begin - end for (_, end), (begin, _) in pairwise(runs)]
    return min(LONGEST_DELAY_S * samples.tick_hz, *(max(1, pause // 2) for pause in pauses), len(samples))


def _windows(samples: Samples, driven: Array, runs: list[tuple[int, int]], longest: int) -> list[_Window]:
    around = AROUND_S * samples.tick_hz
    windows = []
    for begin, end in runs:
        outputs = np.flatnonzero(np.any(driven[begin:end] != 0.0, axis=0))
        if len(outputs) != 1 or not samples.reported[begin:end].all():
            continue  # of two outputs, one right after another, or of nobody knows which
        output = int(outputs[0])
        rows = np.arange(max(0, begin - around), min(len(samples), end + around + longest))
        for first, last in runs:
            if first != begin:
                rows = rows[(rows < first) | (rows > last + longest)]
        rows = rows[whole(samples.field_nt[rows])]
        before, after = (rows < begin).sum(), (rows >= end + longest).sum()
        if before < 2 or after < 2 or len(rows) < CUBIC + 6:
            continue
        basis, _ = np.linalg.qr(np.vander((rows - begin) / around, CUBIC))
        window = _Window(output, rows, begin, samples.field_nt[rows], np.asarray(basis, np.float64))
        windows.append(replace(window, readings=window.without_cubic(window.readings)))
    return windows


def _drive(driven: Array, window: _Window, delay: float) -> Array:
    """What the samples of a window show of the dipole, less its cubic."""
    late, part = int(delay), delay - int(delay)
    own = driven[:, window.output]
    newer = own[np.maximum(window.rows - late, 0)] * (window.rows - late >= 0)
    older = own[np.maximum(window.rows - late - 1, 0)] * (window.rows - late - 1 >= 0)
    return window.without_cubic((1.0 - part) * newer + part * older)


def _at_delay(windows: list[_Window], driven: Array, delay: float) -> _Fit:
    along, weight, total = np.zeros((3, 3)), np.zeros(3), 0.0
    for window in windows:
        shown = _drive(driven, window, delay)
        along[:, window.output] += window.readings.T @ shown
        weight[window.output] += shown @ shown
        total += float((window.readings**2).sum())
    safe = np.where(weight > 0.0, weight, np.inf)
    return _Fit(along / safe, weight, total - float((along**2 / safe).sum()))


def _refined(delays: Array, costs: Array, best: int, noise: float) -> tuple[float, float]:
    """The least of a parabola through the costs about the best delay, and where it has risen by noise^2.

    At whole ticks the costs have a corner, so that the curvature is the least of both sides.
    """
    reach = 4
    if best == 0:
        low, mid, high = costs[reach], costs[0], costs[reach]
    else:
        left, right = max(0, best - reach), min(len(costs) - 1, best + reach)
        low, mid, high = costs[left], costs[best], costs[right]
    step = float(delays[1])
    rise = max(min(low - mid, high - mid), 1e-30) / (reach * step) ** 2
    return float(delays[best]), float(np.hypot(noise / np.sqrt(rise), step / np.sqrt(12.0)))


def _residuals(windows: list[_Window], driven: Array, fit: _Fit, delay: float) -> tuple[Array, Array]:
    if not windows:
        return np.zeros((0, 3)), np.zeros(0)
    left = [w.readings - np.outer(_drive(driven, w, delay), fit.response[:, w.output]) for w in windows]
    return np.vstack(left), np.concatenate([w.rows - w.begin for w in windows]).astype(float)
