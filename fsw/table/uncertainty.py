"""The bounds within which the table is right, and the priors of the filter that follow from them.

A bound is what an engineer can vouch for: the largest deviation that is to be expected. One that the table
leaves out takes an ordinary value for a satellite of that size, never zero. Zero means that the table is
exact there, and the filter does not carry the parameter.

A deviation is taken as uniform within its bound, so that its standard deviation by component is bound / sqrt
3; a misalignment within an angle about any axis, as uniform in that ball: angle / sqrt 5. The age of a sample
lies between zero and its bound.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import hypot, radians, sqrt
from typing import NamedTuple

from pydantic import Field

from fsw.core.algebra.vector import Mat3
from fsw.core.estimation.parameters import MOST_CELLS, Prior
from fsw.input.schema import Section
from fsw.table.ordinary import mean_moment


class UncertaintyTable(Section):
    """Bounds of the errors of the table; None: an ordinary value for a satellite of this size.

    Each may go as far as the models hold (docs/uncertainty.md); other sections limit some (``check_bounds``).
    """

    inertia_percent: float | None = Field(default=None, ge=0.0, le=30.0)
    products_percent: float | None = Field(default=None, ge=0.0, le=20.0)
    residual_dipole_am2: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    coil_gain_percent: float | None = Field(default=None, ge=0.0, le=50.0)
    coil_misalignment_deg: float | None = Field(default=None, ge=0.0, le=10.0)
    magnetometer_bias_nt: float | None = Field(default=None, ge=0.0, le=3000.0)
    magnetometer_scale_percent: float | None = Field(default=None, ge=0.0, le=10.0)
    magnetometer_misalignment_deg: float | None = Field(default=None, ge=0.0, le=10.0)
    sun_misalignment_deg: float | None = Field(default=None, ge=0.0, le=10.0)
    torque_nm: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    torque_variation_nm: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    along_track_km: float | None = Field(default=None, ge=0.0, le=20.0)
    latency_s: float | None = Field(default=None, ge=0.0, le=3.0)
    magnetometer_orbit_nt: float | None = Field(default=None, ge=0.0, le=3000.0)
    magnetometer_shadow_nt: float | None = Field(default=None, ge=0.0, le=3000.0)
    storm_nt: float | None = Field(default=None, ge=0.0, le=3000.0)
    shadow_dipole_am2: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    remanence_percent: float | None = Field(default=None, ge=0.0, le=5.0)
    albedo_percent: float | None = Field(default=None, ge=0.0, le=60.0)
    shadow_impulse_nms: float | None = Field(default=None, ge=0.0, allow_inf_nan=False)
    cell_gain_percent: float | None = Field(default=None, ge=0.0, le=30.0)
    cell_light_percent: float | None = Field(default=None, ge=0.0, le=50.0)


LARGEST_FIELD_T, LEAST_FIELD_T = 5.0e-5, 2.0e-5
"""Strengths of the geomagnetic field in a low orbit."""


class Ceiling(NamedTuple):
    """The largest bound that the rest of a table admits, and what it is."""

    largest: float
    meaning: str


def check_bounds(table: UncertaintyTable, ceilings: Mapping[str, Ceiling]) -> None:
    """Check the bounds that the table gives, by key.

    Raises:
        ValueError: one is above its ceiling.
    """
    for key, (largest, meaning) in ceilings.items():
        given = getattr(table, key)
        if given is not None and given > largest * (1.0 + ROUNDING):
            raise ValueError(
                f"uncertainty.{key} = {given!r} is not allowed: allowed is a number at least 0 and at most "
                f"{largest:.4g}, {meaning}"
            )


ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """The bounds in SI units; parts are relative to the table's value."""

    inertia_part: float
    products_part: float
    dipole_am2: float
    coil_gain_part: float
    coil_turn_rad: float
    mag_bias_t: float
    mag_scale_part: float
    mag_turn_rad: float
    sun_turn_rad: float
    torque_nm: float
    torque_variation_nm: float
    along_track_m: float
    latency_s: float
    mag_orbit_t: float
    mag_shadow_t: float
    storm_t: float
    shadow_dipole_am2: float
    remanence_part: float
    pulse_am2: float
    albedo: float
    shadow_impulse_nms: float
    cell_gain_part: float = 0.0
    cell_light: float = 0.0
    cell_excess: float = 0.0
    earth_light: float = 0.0


SHADOW_PART = 0.07
"""Of the residual dipole, what changes at the shadow's edge with the currents of the solar cells."""
UNEVEN = 0.5
"""Fraction of the error of the Earth's light that differs from cell to cell: clouds are uneven."""


class Ordinary(NamedTuple):
    """Ordinary bounds of what depends on the satellite, by component; its largest pulse.

    Dipole, torque, age of samples, impulse at the shadow's edge; the dipole of the strongest pulse, 0 without
    pulses: what a continuous driver leaves lasts for less than a tick.
    """

    dipole_am2: float
    torque_nm: float
    latency_s: float
    shadow_impulse_nms: float
    pulse_am2: float = 0.0


def bounds(table: UncertaintyTable, ordinary: Ordinary, albedo: float | None = None) -> Uncertainty:
    """The bounds of the table, ordinary ones where it has none.

    ``albedo`` is that of the model of the Sun cells, None for a satellite without them: its ordinary error is
    half of it, or where it is 0 all of the Earth's light.
    """
    torque_nm = _or(table.torque_nm, ordinary.torque_nm)
    dipole_am2 = _or(table.residual_dipole_am2, ordinary.dipole_am2)
    cell_gain, cell_light = (0.0, 0.0) if albedo is None else _of_cells(table, albedo)
    return Uncertainty(
        inertia_part=0.01 * _or(table.inertia_percent, 10.0),
        products_part=0.01 * _or(table.products_percent, 2.0),
        dipole_am2=dipole_am2,
        coil_gain_part=0.01 * _or(table.coil_gain_percent, 5.0),
        coil_turn_rad=radians(_or(table.coil_misalignment_deg, 0.5)),
        mag_bias_t=1e-9 * _or(table.magnetometer_bias_nt, 1000.0),
        mag_scale_part=0.01 * _or(table.magnetometer_scale_percent, 0.5),
        mag_turn_rad=radians(_or(table.magnetometer_misalignment_deg, 1.0)),
        sun_turn_rad=radians(_or(table.sun_misalignment_deg, 0.5)),
        torque_nm=torque_nm,
        torque_variation_nm=_or(table.torque_variation_nm, 0.2 * torque_nm),
        along_track_m=1000.0 * _or(table.along_track_km, 5.0),
        latency_s=_or(table.latency_s, ordinary.latency_s),
        mag_orbit_t=1e-9 * _or(table.magnetometer_orbit_nt, 250.0),
        mag_shadow_t=1e-9 * _or(table.magnetometer_shadow_nt, 400.0),
        storm_t=1e-9 * _or(table.storm_nt, 150.0),
        shadow_dipole_am2=_or(table.shadow_dipole_am2, SHADOW_PART * dipole_am2),
        remanence_part=0.01 * _or(table.remanence_percent, 0.3) if ordinary.pulse_am2 else 0.0,
        pulse_am2=ordinary.pulse_am2,
        albedo=0.0 if albedo is not None else 0.01 * _or(table.albedo_percent, 60.0),
        shadow_impulse_nms=_or(table.shadow_impulse_nms, ordinary.shadow_impulse_nms),
        cell_gain_part=cell_gain,
        cell_light=cell_light,
        cell_excess=cell_light * (UNEVEN if albedo else 1.0),
        earth_light=cell_light if albedo else 0.0,
    )


def _of_cells(table: UncertaintyTable, albedo: float) -> tuple[float, float]:
    """The bounds of gain and Earth's light."""
    light_percent = _or(table.cell_light_percent, 50.0 * albedo or 30.0)
    return 0.01 * _or(table.cell_gain_percent, 10.0), 0.01 * light_percent


def _or(given: float | None, ordinary: float) -> float:
    return ordinary if given is None else given


SIDE = 1.0 / sqrt(3.0)
"""Standard deviation of a component that is uniform within 1."""
BALL = 1.0 / sqrt(5.0)
"""Standard deviation by axis of a vector that is uniform in the ball of radius 1."""
DAY_S = 86400.0
QUARTER_ORBIT_S = 1500.0


class Shape(NamedTuple):
    """Standard deviation, walk per root of a second, and mean of a parameter, as fractions of its limit."""

    sigma: float
    walk: float = 0.0
    mean: float = 0.0


SHAPES = {
    "mag_bias_t": Shape(SIDE, walk=0.1 / sqrt(DAY_S)),
    "torque_body_nm": Shape(SIDE),
    "dipole_body_am2": Shape(SIDE, walk=0.1 / sqrt(DAY_S)),
    "coil_error": Shape(SIDE, walk=0.01),
    "inertia_error_kgm2": Shape(SIDE),
    "mag_turn_rad": Shape(BALL),
    "mag_scale": Shape(SIDE),
    "sun_turn_rad": Shape(BALL),
    "delay_s": Shape(0.5 * SIDE, mean=0.5),
    "cell_excess": Shape(SIDE),
    "cell_gain": Shape(SIDE),
    "earth_light": Shape(SIDE),
}
"""A parameter may wander by a tenth of its limit in a day, the disturbance torque by its own bound, and the
coils by a hundredth in a second, so that a coil's loss of gain in flight is found."""


def priors(known: Uncertainty, inertia_kgm2: Mat3) -> dict[str, Prior]:
    """The prior of each parameter of the filter whose bound is not zero."""
    found = {
        name: Prior(*(tuple(part * limit for limit in largest) for part in SHAPES[name]))
        for name, largest in limits(known, inertia_kgm2).items()
        if any(largest)
    }
    if "mag_bias_t" in found:
        walk = (hypot(found["mag_bias_t"].walk[0], SIDE * known.mag_orbit_t / sqrt(QUARTER_ORBIT_S)),) * 3
        found["mag_bias_t"] = replace(found["mag_bias_t"], walk=walk)
    if known.albedo:  # of a Sun sensor, from none to the bound
        half = 0.5 * known.albedo
        found["earth_light"] = Prior((SIDE * half,), (0.0,), (half,))
    if "torque_body_nm" in found:
        walk = (known.torque_variation_nm / sqrt(DAY_S),) * 3
        found["torque_body_nm"] = replace(found["torque_body_nm"], walk=walk)
    return found


def limits(known: Uncertainty, inertia_kgm2: Mat3) -> dict[str, tuple[float, ...]]:
    """The largest deviation of each parameter of the filter, by component."""
    moments = [inertia_kgm2[axis][axis] * known.inertia_part for axis in range(3)]
    product = mean_moment(inertia_kgm2) * known.products_part
    gain, axis = known.coil_gain_part, known.coil_turn_rad
    remanent_am2 = known.remanence_part * known.pulse_am2
    return {
        "mag_bias_t": (hypot(known.mag_bias_t, known.mag_orbit_t, known.mag_shadow_t),) * 3,
        "torque_body_nm": (known.torque_nm,) * 3,
        "dipole_body_am2": (hypot(known.dipole_am2, known.shadow_dipole_am2, remanent_am2),) * 3,
        "coil_error": (gain, axis, axis, axis, gain, axis, axis, axis, gain),
        "inertia_error_kgm2": (*moments, product, product, product),
        "mag_turn_rad": (known.mag_turn_rad,) * 3,
        "mag_scale": (known.mag_scale_part,) * 3,
        "sun_turn_rad": (known.sun_turn_rad,) * 3,
        "delay_s": (known.latency_s,) * 2,
        "cell_excess": (known.cell_excess,) * MOST_CELLS,
        "cell_gain": (known.cell_gain_part,) * MOST_CELLS,
        "earth_light": (known.earth_light or known.albedo,),
    }
