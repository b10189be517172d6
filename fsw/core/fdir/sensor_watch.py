"""One sensor: what it is suspected of, when it is isolated, and when it is readmitted."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from fsw.core.algebra.vector import ZERO, Vec3, norm, sub
from fsw.core.fdir.sensor_pair import MISFIT, PairConfig


class Sensor(IntEnum):
    """Numbers of the sensors, as reported on the bus."""

    MAGNETOMETER = 1
    SUN_SENSOR = 2


class SensorFault(IntEnum):
    """Faults of a sensor, as reported on the bus."""

    SATURATED = 1
    STRENGTH = 2
    FROZEN = 3
    REFUSED = 4
    SILENT = 5
    UNLIT = 6


FULL, SLIGHT = 3, 2
"""Suspicion of a bad tick: of a check, and of the filter alone. A good tick takes ``FULL`` back."""

STILL = 10
"""A sample counts as still after this part of the time in which it counts as frozen."""

DARK: Vec3 = (0.0, 0.0, 0.0)
"""The sample of a Sun sensor without a Sun."""

AGAINST_ESTIMATE = 4
"""How many times longer both sensors must agree if that contradicts the estimate."""


@dataclass(frozen=True, slots=True)
class SensorHealthConfig:
    """Limits of the checks; ``name_suspicion`` isolates a sensor, ``readmit_ticks`` good samples readmit it.

    ``field_noise_t`` and ``sun_noise_rad`` are the largest deviations that are noise, ``max_bias_t`` and
    ``max_torque_nm`` the largest bias and disturbance with which an estimate proves itself.
    """

    max_field_error_t: float
    max_norm_error: float
    max_angle_error_rad: float
    field_noise_t: float
    sun_noise_rad: float
    max_bias_t: float
    max_torque_nm: float
    frozen_ticks: int
    silent_ticks: int
    name_suspicion: int
    readmit_ticks: int
    pair: PairConfig


class Watch(NamedTuple):
    """One sensor: its fault (0: none), what it is suspected of and how much, and its last sample.

    ``same``: ticks for which the valid sample has not moved; ``missing``: ticks without a sample; ``good``:
    samples as predicted while it is isolated, ``agreed`` those that agree with the other sensor.
    """

    fault: int = 0
    cause: int = 0
    suspicion: int = 0
    same: int = 0
    missing: int = 0
    good: int = 0
    agreed: int = 0
    sample: Vec3 = ZERO

    def integers(self) -> tuple[int, ...]:
        """For the checksum of the state."""
        return self[:-1]


def judge_sample(
    watch: Watch, sample: Vec3 | None, other: Watch, cause: int, weight: int, config: SensorHealthConfig
) -> Watch:
    """The watch after a tick.

    Args:
        watch: of the tick before.
        sample: as the sensor sent it, ``DARK`` of a Sun sensor without a Sun; None if none came.
        other: the watch of the other sensor, of the tick before.
        cause: what speaks against the sample; 0 if nothing does.
        weight: suspicion that this adds.
        config: limits.
    """
    if sample is None:
        return _without_sample(watch, config)
    fault, before, suspicion, same, _, good, agreed, last = watch
    same = same + 1 if sample == last and sample is not DARK else 0
    if fault:
        return Watch(fault, before, 0, same, 0, good, agreed, sample)
    if same >= config.frozen_ticks > 2 * other.same:
        return Watch(SensorFault.FROZEN, same=same, sample=sample)
    if not cause:
        return Watch(0, before, suspicion - FULL if suspicion > FULL else 0, same, 0, 0, 0, sample)
    suspicion += weight
    if suspicion >= config.name_suspicion:
        return Watch(cause, same=same, sample=sample)
    return Watch(0, cause, suspicion, same, 0, 0, 0, sample)


def _without_sample(watch: Watch, config: SensorHealthConfig) -> Watch:
    missing = watch.missing + 1
    if missing < config.silent_ticks or watch.fault:
        return watch._replace(missing=missing)
    return Watch(SensorFault.SILENT, missing=missing, sample=watch.sample)


def probe(watch: Watch, fits: bool, agree: bool, config: SensorHealthConfig) -> tuple[Watch, bool]:
    """An isolated sensor after one more sample.

    Args:
        watch: of this tick.
        fits: the sample is as predicted.
        agree: both sensors agree.
        config: limits.

    Returns:
        The watch, without a fault when enough samples were good, and whether they contradict the estimate.
    """
    good = watch.good + 1 if fits and watch.same == 0 else max(0, watch.good - MISFIT)
    agreed = watch.agreed + 1 if agree and watch.same == 0 else max(0, watch.agreed - MISFIT)
    if good >= config.readmit_ticks:
        return Watch(sample=watch.sample), False
    if agreed >= AGAINST_ESTIMATE * config.readmit_ticks:
        return Watch(sample=watch.sample), True
    return watch._replace(good=good, agreed=agreed), False


def as_predicted(sample: Vec3, agree: bool, predicted: Vec3 | None, noise: float, sigma3_rad: float) -> bool:
    """Whether a sample is what the estimate predicts; without an estimate, whether both sensors agree."""
    if predicted is None:
        return agree
    return norm(sub(sample, predicted)) < noise + sigma3_rad * norm(predicted)
