"""One sensor: what it is suspected of, when it is named, and when it may be believed again."""

from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from fsw.core.algebra.vector import ZERO, Vec3, norm, sub
from fsw.core.fdir.sensor_pair import MISFIT, PairConfig


class Sensor(IntEnum):
    """Numbers of the sensors, as named on the bus."""

    MAGNETOMETER = 1
    SUN_SENSOR = 2


class SensorFault(IntEnum):
    """What is wrong with a sensor, as named on the bus."""

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
"""The sample of a Sun sensor that sees nothing."""

AGAINST_ESTIMATE = 4
"""So many times longer both sensors must agree before they are believed against the estimate."""


@dataclass(frozen=True, slots=True)
class SensorHealthConfig:
    """Limits of the checks; ``name_suspicion`` names a sensor, ``readmit_ticks`` good samples bring it back.

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
    samples that the estimate foretold while it is left out, ``agreed`` those that the other sensor bears out.
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


def watched(
    watch: Watch, said: Vec3 | None, other: Watch, cause: int, weight: int, config: SensorHealthConfig
) -> Watch:
    """The watch after a tick, ``said`` being the raw sample, ``DARK`` where there was nothing to be seen."""
    if said is None:
        return _unheard(watch, config)
    fault, before, suspicion, same, _, good, agreed, sample = watch
    same = same + 1 if said == sample and said is not DARK else 0
    if fault:
        return Watch(fault, before, 0, same, 0, good, agreed, said)
    if same >= config.frozen_ticks > 2 * other.same:
        return Watch(SensorFault.FROZEN, same=same, sample=said)
    if not cause:
        return Watch(0, before, suspicion - FULL if suspicion > FULL else 0, same, 0, 0, 0, said)
    suspicion += weight
    if suspicion >= config.name_suspicion:
        return Watch(cause, same=same, sample=said)
    return Watch(0, cause, suspicion, same, 0, 0, 0, said)


def _unheard(watch: Watch, config: SensorHealthConfig) -> Watch:
    missing = watch.missing + 1
    if missing < config.silent_ticks or watch.fault:
        return watch._replace(missing=missing)
    return Watch(SensorFault.SILENT, missing=missing, sample=watch.sample)


def probed(watch: Watch, fits: bool, agree: bool, config: SensorHealthConfig) -> tuple[Watch, bool]:
    """A sensor that is left out, back when enough samples were good; and whether the estimate is doubted."""
    good = watch.good + 1 if fits and watch.same == 0 else max(0, watch.good - MISFIT)
    agreed = watch.agreed + 1 if agree and watch.same == 0 else max(0, watch.agreed - MISFIT)
    if good >= config.readmit_ticks:
        return Watch(sample=watch.sample), False
    if agreed >= AGAINST_ESTIMATE * config.readmit_ticks:
        return Watch(sample=watch.sample), True
    return watch._replace(good=good, agreed=agreed), False


def as_foretold(sample: Vec3, agree: bool, foretold: Vec3 | None, noise: float, sigma3_rad: float) -> bool:
    """Whether a sample is what the estimate foretells; without one, whether both sensors agree."""
    if foretold is None:
        return agree
    return norm(sub(sample, foretold)) < noise + sigma3_rad * norm(foretold)
