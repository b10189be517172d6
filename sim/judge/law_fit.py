"""Whether a law brakes, by the dipoles that flowed, and if not, what mistake would explain them.

The torque m x B does work m . (B x w) on a body that turns at w against the orbital frame, so that the dipole
that brakes it most points along d = w x B. Where the body turns fast, a law that brakes has a large cosine
between its dipoles and d. If it has not, the dipoles are compared with those that a mistake would make of d:
each of the 48 signed permutations of the axes, and a field of another time; and with what brakes by samples
whose 16 bits are read with their bytes the other way round, or as unsigned.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from numpy.typing import NDArray

from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import rotated
from sim.scenario.schema import Scenario, orbit_period_s
from sim.value_types import Array

FAST = 5.0
"""Times the orbital rate from which on the body counts as turning; slower it may do as gravity wants."""
LEAST_PULSES = 8
FITS, SIGMAS = 0.5, 3.0
"""Mean cosine of what counts as explained, and by how many standard errors it must be better."""
EVERY_S = 30.0
"""Time between two dipoles of a continuous driver that are taken: those between tell the same."""
LEAST_PART = 0.02
"""Of the largest dipole: a smaller one is not counted."""
DIFFER, LEAST_DIFFERENT = 0.5, 4
"""Between the cosines by two readings of the samples, where these differ, and in how many dipoles: as
unsigned a field is read wrongly only while it passes zero."""
SHIFT_S = 60.0
SPANS = range(1, 31)
"""Ticks over which a law may take the change of the field."""
AXES = "xyz"
Rows = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class LawFit:
    """What was found.

    Attributes:
        pulses: dipoles that were compared; 0: the body did not turn fast for long enough.
        brakes: mean cosine between them and the dipole that brakes most.
        work_j: work of the coils on the body meanwhile; negative: they brake it.
        mistake: in words; empty: none explains them better than none.
    """

    pulses: int
    brakes: float = 0.0
    work_j: float = 0.0
    mistake: str = ""


def fit_law(scenario: Scenario, truth: Histories, samples: NDArray[np.int16] | None = None) -> LawFit:
    """Compare the dipoles of a flight with those that brake.

    Args:
        scenario: that was flown.
        truth: the plant's histories.
        samples: by tick the numbers of MAG_FIELD, (n, 3), raw; None: they are not known.
    """
    rows = _rows(scenario, truth)
    if len(rows) < LEAST_PULSES:
        return LawFit(0)
    m = _unit(truth["m_body_am2"][rows + 1])
    omega, b = truth["omega_body_orbit_radps"][rows], truth["b_body_t"][rows]
    braking = _unit(np.cross(omega, b))
    as_is = np.sum(m * braking, axis=1)
    work_j = _work_j(scenario, truth)
    found = [
        *_as_signed_axes(m, braking, as_is),
        *_as_other_time(scenario, truth, rows, m, omega, as_is),
        *(() if samples is None else _as_misread(samples, rows, m, omega, as_is)),
    ]
    # of those that explain it about as well the simplest, which comes first
    best = max((one.mean for one in found), default=0.0)
    mistake = next((one.words for one in found if one.mean > 0.95 * best), "")
    mean = float(as_is.mean())
    if mistake:
        mistake += (
            f": over {len(rows)} dipoles at more than {least_degps(scenario):.2g} deg/s the mean cosine to "
            f"the one that brakes is {mean:.2f}, and {best:.2f} with that mistake"
        )
    return LawFit(len(rows), mean, work_j, mistake)


@dataclass(frozen=True, slots=True)
class _Explanation:
    words: str
    mean: float


def _rows(scenario: Scenario, truth: Histories) -> Rows:
    """The ticks in which a dipole began to flow, or a continuous one is taken, while the body turned fast."""
    m = np.linalg.norm(truth["m_body_am2"], axis=1)
    flows = m > LEAST_PART * max(float(m.max(initial=0.0)), 1e-30)
    rate = np.linalg.norm(truth["omega_body_orbit_radps"], axis=1)
    fast = rate > np.radians(least_degps(scenario))
    if scenario.coils.driver == "continuous":
        begins = np.zeros(len(m), dtype=bool)
        begins[:: max(1, round(EVERY_S * scenario.time.tick_hz))] = True
        begins[1:] &= flows[1:]
        begins[0] = False
    else:
        begins = flows.copy()
        begins[1:] &= ~flows[:-1]
        begins[0] = False
    return np.flatnonzero(begins[1:] & fast[:-1])


def least_degps(scenario: Scenario) -> float:
    """The rate above which a body turns fast against its orbit, deg/s."""
    return FAST * 360.0 / orbit_period_s(scenario)


def _work_j(scenario: Scenario, truth: Histories) -> float:
    torque = truth.get("torque_body_nm/coils")
    if torque is None:
        return 0.0
    omega = truth["omega_body_orbit_radps"]
    return float(np.sum(torque[1:] * omega[:-1]) / scenario.time.tick_hz)


def _as_signed_axes(m: Array, braking: Array, as_is: Array) -> Iterator[_Explanation]:
    """Mistakes of sign and of the order of the axes, the simplest first."""
    turns = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            changed = sum(one != place for place, one in enumerate(order))
            minus = signs.count(-1.0)
            turns.append(((changed, min(minus, 0 if minus == 3 else minus)), order, signs))
    for _, order, signs in sorted(turns):
        if order == (0, 1, 2) and signs.count(-1.0) == 0:
            continue
        meant = braking[:, order] * np.array(signs)
        fit = np.sum(m * meant, axis=1)
        if _is_better(fit, as_is):
            yield _Explanation(_words(order, signs), float(fit.mean()))


def _words(order: tuple[int, ...], signs: tuple[float, ...]) -> str:
    minus = [AXES[place] for place, sign in enumerate(signs) if sign < 0.0]
    if len(minus) == 3 and order == (0, 1, 2):
        return "a sign error: its dipoles speed the body up instead of braking it"
    signed = f"the sign of {' and '.join(minus)} is wrong" if minus else ""
    moved = [place for place, one in enumerate(order) if one != place]
    if not moved:
        return f"a sign error: {signed}"
    if len(moved) == 2:
        swapped = f"the axes {AXES[moved[0]]} and {AXES[moved[1]]} are swapped"
    else:
        taken = (f"{AXES[one]} is taken for {AXES[place]}" for place, one in enumerate(order))
        swapped = f"the axes are mixed up: {', '.join(taken)}"
    return f"{swapped}, and {signed}" if signed else swapped


def _as_other_time(
    scenario: Scenario, truth: Histories, rows: Rows, m: Array, omega: Array, as_is: Array
) -> Iterator[_Explanation]:
    """A field of another time: that at another place of the orbit, seen from the same attitude."""
    hz, period = scenario.time.tick_hz, round(orbit_period_s(scenario) * scenario.time.tick_hz)
    step = max(1, round(SHIFT_S * hz))
    q = truth["q_body_from_orbit"]
    b_orbit = rotated(q * np.array((1.0, -1.0, -1.0, -1.0)), truth["b_body_t"])
    best: tuple[float, int] | None = None
    for shift in range(-period // 2, period // 2 + 1, step):
        if abs(shift) < step:
            continue
        there = rows + shift
        there = np.where(there < 0, there + period, there)
        there = np.where(there >= len(q), there - period, there)
        if there.min() < 0 or there.max() >= len(q):
            continue
        fit = np.sum(m * _unit(np.cross(omega, rotated(q[rows], b_orbit[there]))), axis=1)
        if _is_better(fit, as_is) and (best is None or fit.mean() > best[0]):
            best = float(fit.mean()), shift
    if best is not None:
        mean, shift = best
        when = "later" if shift > 0 else "earlier"
        yield _Explanation(
            f"a wrong epoch: its field is the one of about {abs(shift) / hz:.0f} s {when}, or of whole "
            "orbits more",
            mean,
        )


def _as_misread(
    samples: NDArray[np.int16], rows: Rows, m: Array, omega: Array, as_is: Array
) -> Iterator[_Explanation]:
    """The samples as they come of mistakes in reading their 16 bits.

    A law takes the change of the field over some ticks, or its cross product with the rate. A mistake
    explains its dipoles only if they fit one of these, of the samples so read, better than each of them of
    the samples read properly.
    """
    spans = [span for span in SPANS if (rows >= span).sum() >= LEAST_PULSES]
    proper = _best_of_fields(samples.astype(float), spans, rows, m, omega)
    for words, read in MISREAD.items():
        best = _best_of_fields(read(samples), spans, rows, m, omega)
        known = ~np.isnan(best) & ~np.isnan(proper)
        differ = known & (np.abs(best - proper) > DIFFER)
        fits = float(best[known].mean()) > as_is[known].mean() and differ.sum() >= LEAST_DIFFERENT
        if fits and _is_better(best[differ], proper[differ]):
            yield _Explanation(words, float(best[known].mean()))


MISREAD: dict[str, Callable[[NDArray[np.int16]], Array]] = {
    "the byte order of MAG_FIELD is wrong: it is read the other way round": lambda samples: (
        samples.byteswap().astype(float)
    ),
    "MAG_FIELD is read as unsigned: a field below zero comes out as 65536 steps more": lambda samples: (
        samples.view(np.uint16).astype(float)
    ),
}
"""Mistakes in reading the samples: in words, and what the samples are then."""


def _best_of_fields(field: Array, spans: Sequence[int], rows: Rows, m: Array, omega: Array) -> Array:
    """The cosines of the dipoles to what brakes by this field, taken in the way that fits best; or NaN."""
    ways = [np.sum(m * _unit(np.cross(omega, field[rows])), axis=1)]
    for span in spans:
        fit = np.sum(m * _unit(field[rows - span] - field[rows]), axis=1)
        ways.append(np.where(rows >= span, fit, np.nan))
    return max(ways, key=lambda fit: float(np.nanmean(fit)))


def _is_better(fit: Array, as_is: Array) -> bool:
    """Whether an explanation fits well, and beyond chance better than none."""
    gain = fit - as_is
    error = float(gain.std()) / np.sqrt(len(gain))
    return float(fit.mean()) > FITS and float(gain.mean()) > SIGMAS * error


def _unit(v: Array) -> Array:
    size = np.linalg.norm(v, axis=1, keepdims=True)
    result: Array = np.divide(v, size, out=np.zeros_like(v), where=size > 0.0)
    return result
