"""The flight filter over a pass: magnetometer alone, from a start; and its prediction without any sample."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import nan, radians
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fsw.core.algebra.quaternion import from_dcm, rotate
from fsw.core.algebra.vector import ZERO, Mat3, Vec3, norm, scale, sub
from fsw.core.estimation import mekf
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig, mekf_config
from fsw.core.estimation.parameters import Prior
from fsw.core.orbit.earth import MU_M3PS2
from fsw.core.orbit.ephemeris import Reference
from sim.commissioning.recorded.along import Along, sampled
from sim.commissioning.recorded.calibration import PassCalibration
from sim.commissioning.telemetry.spin import Spin
from sim.errors import HarnessError
from sim.progress import progress
from sim.value_types import Array, vec3

T_PER_NT = 1e-9
LONGEST_GAP_S = 600.0
"""Between samples, over which the filter may predict."""


@dataclass(frozen=True, slots=True)
class Noise:
    """What the filter expects of a pass, standard deviations.

    Of a field component, nT; of the carried bias, nT, and how it walks, nT per root of a second; of the rate,
    how it walks, deg/s per root of a second (about the axis of greatest inertia); of the start, deg, deg/s.
    """

    field_nt: float = 600.0
    bias_nt: float = 3000.0
    bias_walk_nt_rts: float = 20.0
    rate_walk_degps_rts: float = 0.004
    attitude_deg: float = 15.0
    rate_degps: float = 0.3
    gate_nis: float = 60.0


class Taken(NamedTuple):
    """What a tick with a sample left: number of the row, estimate after it, innovation, NIS, whether taken.

    ``direction_deg`` and ``strength_nt``: predicted less measured, the bias as estimated before taken off.
    """

    row: int
    estimate: Estimate
    direction_deg: float
    strength_nt: float
    nis: float
    taken: bool


@dataclass(frozen=True, slots=True)
class Followed:
    """A pass as the filter followed it from a start."""

    start: Spin
    config: MekfConfig
    ticks: tuple[Taken, ...]

    @property
    def rows(self) -> NDArray[np.int64]:
        """The rows of the pass that were offered to the filter."""
        return np.array([one.row for one in self.ticks])

    @property
    def direction_deg(self) -> Array:
        """Angles between predicted and measured field."""
        return np.array([one.direction_deg for one in self.ticks])

    @property
    def strength_nt(self) -> Array:
        """Predicted less measured strengths."""
        return np.array([one.strength_nt for one in self.ticks])

    @property
    def rate_degps(self) -> Array:
        """Estimated rates, body axes, (n, 3)."""
        return np.degrees([one.estimate.omega_body_radps for one in self.ticks])

    @property
    def bias_nt(self) -> Array:
        """Estimated biases beyond the calibration, body axes, (n, 3)."""
        return np.array([one.estimate.parameters.mag_bias_t for one in self.ticks]) / T_PER_NT


def filter_config(
    inertia: Array, tick_s: float, noise: Noise, inertia_sigma: Array | None = None
) -> MekfConfig:
    """The filter of a body whose greatest moment of inertia is 1; ``inertia_sigma``: of its six numbers."""
    first, second, third = (vec3(row) for row in inertia)
    tensor: Mat3 = (first, second, third)
    bias_t, walk_t = T_PER_NT * noise.bias_nt, T_PER_NT * noise.bias_walk_nt_rts
    priors = {"mag_bias_t": Prior((bias_t,) * 3, (walk_t,) * 3)}
    if inertia_sigma is not None:
        priors["inertia_error_kgm2"] = Prior(tuple(inertia_sigma.tolist()), (0.0,) * 6)
    return mekf_config(
        tensor,
        tick_s,
        priors,
        magnetometer_sigma_t=T_PER_NT * noise.field_nt,
        sun_sigma_rad=1.0,
        attitude_sigma_rad=radians(noise.attitude_deg),
        rate_sigma_radps=radians(noise.rate_degps),
        torque_noise_nm_rts=radians(noise.rate_walk_degps_rts),
        gate_nis=noise.gate_nis,
    )


def follow(around: Along, known: PassCalibration, start: Spin, config: MekfConfig) -> Followed:
    """Run the filter from a start at the first sample to the end of the pass.

    Raises:
        HarnessError: a gap between two samples is too long to be predicted.
    """
    rows = sampled(around)
    _check_gaps(around, rows)
    field_t = T_PER_NT * known.field_nt(around.recorded.mag_nt)
    attitude = from_dcm(_mat3(start.dcm_body_from_eci))
    estimate = mekf.start(attitude, vec3(start.omega_body_radps), config)
    bias_t = vec3(T_PER_NT * start.bias_nt)
    estimate.parameters.mag_bias_t = bias_t
    ticks, before = [], int(around.tick[rows[0]])
    with progress(f"{around.recorded.name}, {start.rate_degps:.2f} deg/s", len(rows)) as watch:
        for done, row in enumerate(rows.tolist()):
            now = int(around.tick[row])
            reference = around.references[now]
            coast(estimate, reference, now - before, config)
            taken = _take(row, estimate, vec3(field_t[row]), reference, config)
            before = now
            ticks.append(taken)
            watch(done)
    return Followed(start, config, tuple(ticks))


def coast(estimate: Estimate, reference: Reference, ticks: int, config: MekfConfig) -> None:
    """Carry the estimate over so many ticks without a sample."""
    e1_eci = scale(1.0 / reference.radius_m, reference.r_eci_m)
    gravity_per_s2 = 3.0 * MU_M3PS2 / reference.radius_m**3
    for _ in range(ticks):
        mekf.predict(estimate, e1_eci, reference.b_eci_t, gravity_per_s2, ZERO, config)


def without_sample(
    around: Along, known: PassCalibration, begun: Taken, config: MekfConfig
) -> Iterator[tuple[int, float]]:
    """From the estimate after a row on, without any sample: ticks since, and angle to the field, deg."""
    start = int(around.tick[begun.row])
    field_t = T_PER_NT * known.field_nt(around.recorded.mag_nt)
    estimate, before = begun.estimate.copy(), start
    rows = sampled(around)
    for row in rows[rows > begun.row].tolist():
        now = int(around.tick[row])
        reference = around.references[now]
        coast(estimate, reference, now - before, config)
        before = now
        measured = sub(vec3(field_t[row]), estimate.parameters.mag_bias_t)
        predicted = rotate(estimate.q_body_from_eci, reference.b_eci_t)
        yield now - start, _angle_deg(measured, predicted)


def _take(row: int, estimate: Estimate, field_t: Vec3, reference: Reference, config: MekfConfig) -> Taken:
    """Offer a sample to the filter: what it lacked beforehand, and a copy of the estimate afterwards."""
    predicted = rotate(estimate.q_body_from_eci, reference.b_eci_t)
    measured = sub(field_t, estimate.parameters.mag_bias_t)
    took = mekf.update_field(estimate, field_t, reference.b_eci_t, config)
    return Taken(
        row,
        estimate.copy(),
        _angle_deg(measured, predicted),
        (norm(predicted) - norm(measured)) / T_PER_NT,
        estimate.nis if took else nan,
        took,
    )


def _check_gaps(around: Along, rows: NDArray[np.int64]) -> None:
    gaps_s = np.diff(around.t_s[rows])
    if len(gaps_s) and gaps_s.max() > LONGEST_GAP_S:
        place = int(rows[np.argmax(gaps_s)])
        raise HarnessError(
            f"{around.recorded.name}: after utc_unix_s = {around.recorded.utc_unix_s[place]:.15g} there is "
            f"no field sample for {gaps_s.max():.0f} s; at most {LONGEST_GAP_S:.0f} s are predicted, so "
            "split the file there"
        )


def _angle_deg(a: Vec3, b: Vec3) -> float:
    lengths = norm(a) * norm(b)
    cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / lengths if lengths > 0.0 else 1.0
    return float(np.degrees(np.arccos(min(1.0, max(-1.0, cosine)))))


def directions_body(followed: Followed, v_eci: Array) -> Array:
    """Directions fixed in space as the filter has them in body axes, by the rows offered to it, (n, 3)."""
    return np.array(
        [
            rotate(one.estimate.q_body_from_eci, vec3(v))
            for one, v in zip(followed.ticks, v_eci[followed.rows], strict=True)
        ]
    )


def _mat3(values: Array) -> Mat3:
    first, second, third = (vec3(row) for row in values)
    return first, second, third
