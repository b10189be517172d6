"""Figures of a followed pass, and whether its motion is distinguished from others that the field allows."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sim.commissioning.recorded.along import Along, sample_hz, sampled, without
from sim.commissioning.recorded.calibration import PassCalibration
from sim.commissioning.telemetry.follow import Followed, Noise, filter_config, follow
from sim.commissioning.telemetry.held_back import Azimuths, coasts_deg, sun_azimuths
from sim.commissioning.telemetry.spin import spin_axis, spins, stray_directions
from sim.value_types import Array

START_S = 400.0
"""Field of so long a time starts the filter; a shorter pass is started by all it has."""
SETTLING_S = {"long": 600.0, "short": 60.0}
"""Time after the first sample from which figures count."""
LONG_S = 1000.0
"""Length from which a pass is long."""
DISTINCT = 1e-6
"""The greatest moment of inertia stands out by at least this part."""
ALIKE_DEG = 3.0
"""Motions whose attitudes differ by less are one."""
LEAST_CELL_ROWS = 3
"""Rows with two cells lit that count as a look at the Sun."""
CLEARLY = 0.6
"""One motion is distinguished from another where it leaves at most this part of the other's error."""
MOST_AZIMUTH_DEG, MOST_SCATTER_DEG = 20.0, 20.0
"""Of the Sun by the cells: beyond these a motion is wrong although no other contends."""
MOST_COAST_DEG, MOST_DIRECTION_DEG = 10.0, 10.0
"""Of the field after coasting, and of the next sample: as above."""
REFUSED, NOT_TURNING = "that the filter refused", "whose field does not turn with the others"
MOTION = (REFUSED, NOT_TURNING)
LEAST_COAST_S = 60
"""So long a prediction without samples bears a motion out where the cells do not."""


@dataclass(frozen=True, slots=True)
class AllowedMotion:
    """A motion that the field allows, as the filter followed it, with what it did not use.

    ``settled``: place of the first sample that counts.
    """

    followed: Followed
    settled: int
    azimuths: Azimuths
    coasts_deg: dict[int, Array]

    @property
    def direction_deg_rms(self) -> float:
        """Of the field as predicted from the samples before."""
        return rms(self.followed.direction_deg[self.settled :])

    @property
    def strength_nt_rms(self) -> float:
        """Of the strength of the field, with the bias as estimated."""
        return rms(self.followed.strength_nt[self.settled :])

    def coast_deg_rms(self) -> dict[int, float | None]:
        """By time without a sample; None where the pass is too short."""
        return {horizon: rms(angles) if len(angles) else None for horizon, angles in self.coasts_deg.items()}

    @property
    def rate_degps(self) -> float:
        """Mean rate about the body axis that is nearest to the axis of spin."""
        place = spin_place(self.followed.start.omega_body_radps)
        return float(self.followed.rate_degps[self.settled :, place].mean())

    def held_back(self, told_by: str) -> Azimuths:
        """The azimuths that count: after the start, and none that distinguished the motion from others."""
        middle = len(self.followed.ticks) // 2 if told_by == "cells" else 0
        return self.azimuths.within(max(self.settled, middle), len(self.followed.ticks))

    def longest_coast(self) -> tuple[int, float] | None:
        """The longest time without a sample that there is, and the error after it."""
        found = [(horizon, value) for horizon, value in self.coast_deg_rms().items() if value is not None]
        return found[-1] if found else None


class MotionVerdict(NamedTuple):
    """Whether a motion may be believed, and why.

    ``by``: what distinguished it from the others: ``cells``, ``coasting``, ``field``, or nothing.
    """

    converged: bool
    by: str
    reason: str


@dataclass(frozen=True, slots=True)
class Judged:
    """A pass: the axis of spin, the motions that its field allows, the best first, and the verdict on it."""

    around: Along
    axis_body: Array
    motions: tuple[AllowedMotion, ...]
    verdict: MotionVerdict

    @property
    def best(self) -> AllowedMotion:
        """The motion that is believed most."""
        return self.motions[0]


def spin_place(axis: Array) -> int:
    """Which of the body axes, 0 to 2, is nearest to an axis."""
    return int(np.argmax(np.abs(axis)))


def judge(around: Along, known: PassCalibration, noise: Noise, start_s: float = START_S) -> Judged:
    """Follow the pass from every start that its field allows, and tell them apart by what was not used.

    A sample that points far from the spin that starts the filter, or that the filter refuses, is left out of
    the pass, which is judged again without it, as long as these are no more than a tenth of its rows:
    beyond that it is the filter that is wrong, and what it refuses counts as its error.

    Raises:
        HarnessError: a gap between samples is too long.
    """
    while True:
        judged = _judged(around, known, noise, start_s)
        fewer = _without_refused(judged)
        if fewer is judged.around:
            return judged
        around = fewer


def _without_refused(judged: Judged) -> Along:
    """The pass without the samples that the filter refused; as it is where those are none, or too many."""
    around, refused = judged.around, np.zeros(len(judged.around.lit), dtype=np.bool_)
    refused[[one.row for one in judged.best.followed.ticks if not one.taken]] = True
    return (
        without(around, refused, REFUSED) if around.recorded.may_lack(int(refused.sum()), *MOTION) else around
    )


def _judged(around: Along, known: PassCalibration, noise: Noise, start_s: float) -> Judged:
    """The pass, judged with all its rows but those that no spin explains."""
    rows = sampled(around)
    t_s = around.t_s[rows]
    first = t_s <= t_s[0] + start_s
    field_nt = known.field_nt(around.recorded.mag_nt)[rows]
    axis = turning_axis(known, field_nt)
    starts = spins(t_s[first], field_nt[first], around.b_eci_nt[rows][first], axis, sample_hz(around))
    strays = np.zeros(len(around.lit), dtype=np.bool_)
    strays[rows[first]] = stray_directions(
        t_s[first], field_nt[first], around.b_eci_nt[rows][first], axis, starts[0]
    )
    if strays.any() and around.recorded.may_lack(int(strays.sum()), *MOTION):
        return _judged(without(around, strays, NOT_TURNING), known, noise, start_s)
    config = filter_config(known.inertia, around.tick_s, noise)
    settling_s = SETTLING_S["long" if t_s[-1] - t_s[0] > LONG_S else "short"]
    settled = int(np.searchsorted(t_s, t_s[0] + min(settling_s, 0.5 * (t_s[-1] - t_s[0]))))
    followed = different([follow(around, known, start, config) for start in starts])
    errors = [_as_error(rms(one.direction_deg[settled:])) for one in followed]
    motions = []
    for one, error in zip(followed, errors, strict=True):
        contends = CLEARLY * error <= min(errors)
        coasts = coasts_deg(around, known, one, settled) if contends else {}
        motions.append(AllowedMotion(one, settled, sun_azimuths(around, known, one, axis), coasts))
    ordered, verdict = rank_motions(motions)
    return Judged(around, axis, tuple(ordered), verdict)


def different(followed: list[Followed]) -> list[Followed]:
    """Without those that have come to the motion of one before: in the last third they turn alike."""
    kept: list[Followed] = []
    for one in followed:
        if all(apart_deg(one, other) > ALIKE_DEG for other in kept):
            kept.append(one)
    return kept


def apart_deg(one: Followed, other: Followed) -> float:
    """The median angle between the attitudes of two motions, over the last third of the samples."""
    last = len(one.ticks) // 3
    pairs = zip(one.ticks[-last:], other.ticks[-last:], strict=True)
    cosines = [
        abs(sum(map(float.__mul__, a.estimate.q_body_from_eci, b.estimate.q_body_from_eci))) for a, b in pairs
    ]
    return float(np.degrees(2.0 * np.arccos(min(1.0, float(np.median(cosines))))))


def turning_axis(known: PassCalibration, field_nt: Array) -> Array:
    """The axis of greatest inertia; where no moment is the greatest, that across which the field turns."""
    moments = np.linalg.eigvalsh(known.inertia)
    return known.spin_axis if moments[2] - moments[1] > DISTINCT else spin_axis(field_nt)


def rank_motions(motions: list[AllowedMotion]) -> tuple[list[AllowedMotion], MotionVerdict]:
    """The motions in the order of belief, and what is to be said of the first.

    The field decides where it clearly does; then the cells, of the first half of the pass alone, so that
    those of the second half still are held back; then what the motions predict without samples.
    """
    ordered = sorted(motions, key=_by_field)
    contenders = [one for one in ordered if CLEARLY * _by_field(one) <= _by_field(ordered[0])]
    for by, score in (("cells", _by_cells), ("coasting", _by_coasting)):
        if len(contenders) == 1:
            return ordered, _alone(ordered[0], "field")
        scores = [score(motion) for motion in contenders]
        if not all(np.isfinite(scores)):
            continue
        best, second, *_ = sorted(range(len(contenders)), key=scores.__getitem__)
        if scores[best] <= CLEARLY * scores[second]:
            likeliest = contenders[best]
            return [likeliest, *(one for one in ordered if one is not likeliest)], _alone(likeliest, by)
    rates = " and ".join(f"{motion.rate_degps:.2f}" for motion in contenders)
    said = f"motions of {rates} deg/s fit the field alike, and neither cells nor coasting tell them apart"
    return ordered, MotionVerdict(False, "", said)


def _alone(motion: AllowedMotion, by: str) -> MotionVerdict:
    """The verdict on a motion that stands alone: what was not used must agree with it."""
    azimuths, coast = motion.held_back(by), motion.longest_coast()
    seen = len(azimuths.rows) >= LEAST_CELL_ROWS
    long = coast is not None and coast[0] >= LEAST_COAST_S
    if not motion.direction_deg_rms <= MOST_DIRECTION_DEG:
        fault = f"the field is off by {motion.direction_deg_rms:.0f} deg: the filter is lost"
    elif seen and not _agrees(azimuths):
        off, scatter = azimuths.median_deg, azimuths.scatter_deg
        fault = f"the Sun that the cells see is off by {off:.0f} deg, scattered by {scatter:.0f} deg"
    elif coast is not None and coast[1] > MOST_COAST_DEG:
        fault = f"without samples the field is off by {coast[1]:.0f} deg after {coast[0]} s"
    else:
        fault = "" if seen or long else "neither cells nor a minute of coasting bear the motion out"
    return MotionVerdict(not fault, by, fault)


def _agrees(azimuths: Azimuths) -> bool:
    return abs(azimuths.median_deg) <= MOST_AZIMUTH_DEG and azimuths.scatter_deg <= MOST_SCATTER_DEG


def _by_cells(motion: AllowedMotion) -> float:
    shown = motion.azimuths.within(0, len(motion.followed.ticks) // 2)
    return shown.rms_deg if len(shown.rows) >= LEAST_CELL_ROWS else np.inf


def _by_coasting(motion: AllowedMotion) -> float:
    coast = motion.longest_coast()
    return np.inf if coast is None else coast[1]


def _by_field(motion: AllowedMotion) -> float:
    return _as_error(motion.direction_deg_rms)


def _as_error(value: float) -> float:
    """The value; infinite where it is no number, since that is worse than any."""
    return float("inf") if np.isnan(value) else value


def _mean_nis(motion: AllowedMotion) -> float:
    taken = [one.nis for one in motion.followed.ticks[motion.settled :] if one.taken]
    return float(np.mean(taken)) if taken else float("nan")


def rms(values: Array) -> float:
    """Root of the mean of the squares."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")


def mean_gyro(gyro_degps: Array) -> Array | None:
    """The mean by axis of gyro samples, (n, 3), deg/s; None where an axis has none."""
    if not np.isfinite(gyro_degps).any(axis=0).all():
        return None
    mean: Array = np.nanmean(gyro_degps, axis=0)
    return mean


def figures(judged: Judged) -> dict[str, Any]:
    """The figures of the motion that is believed most, for the JSON document."""
    motion, around = judged.best, judged.around
    rows = motion.followed.rows[motion.settled :]
    rates = motion.followed.rate_degps[motion.settled :].mean(axis=0)
    gyro = None if around.recorded.gyro_degps is None else mean_gyro(around.recorded.gyro_degps[rows])
    azimuths = motion.held_back(judged.verdict.by)
    return {
        "converged": judged.verdict.converged,
        "told_by": judged.verdict.by or None,
        "reason": judged.verdict.reason or None,
        "rows": len(around.recorded.utc_unix_s),
        "rows_left_out": [one._asdict() for one in around.recorded.left_out],
        "rows_of_unknown_moment": int((~around.first_of_tick).sum()),
        "rejected": sum(not one.taken for one in motion.followed.ticks),
        "field_norm_nt_rms": motion.strength_nt_rms,
        "field_direction_deg_rms": motion.direction_deg_rms,
        "rate_y_degps_mean": float(rates[1]),
        "gyro_y_degps_mean": None if gyro is None else float(gyro[1]),
        "rate_degps_mean": rates.tolist(),
        "gyro_degps_mean": None if gyro is None else gyro.tolist(),
        "coast_deg_rms": {str(horizon): value for horizon, value in motion.coast_deg_rms().items()},
        "sun_azimuth_deg": {
            "median": None if not len(azimuths.rows) else azimuths.median_deg,
            "rms": None if not len(azimuths.rows) else azimuths.scatter_deg,
            "rows": len(azimuths.rows),
        },
        "nis_mean": _mean_nis(motion),
        "bias_nt": motion.followed.bias_nt[-1].tolist(),
        "motions_degps": [one.rate_degps for one in judged.motions],
        "elements_age_days": around.elements.age_days(around.recorded.middle_unix_s),
    }
