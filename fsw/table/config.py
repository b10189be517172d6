"""From a checked onboard table to the config the core uses: units of the file to SI, seconds to ticks."""

from collections.abc import Mapping
from math import ceil, cos, radians
from typing import Any

from fsw.core.actuation.actuator import ActuatorConfig
from fsw.core.actuation.dipoles import DipoleConfig
from fsw.core.actuation.pulses import PulseConfig, pulse_timing
from fsw.core.actuation.read_back import ReadBackConfig
from fsw.core.algebra.vector import ZERO, Vec3, inverse, product, scale, transform, transpose
from fsw.core.config import FlightConfig
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.fdir.coils.health import CoilHealthConfig
from fsw.core.fdir.coils.weak_test import weak_test
from fsw.core.fdir.evidence import weights
from fsw.core.fdir.fdir import FdirConfig
from fsw.core.fdir.sensors.credibility import credibility_config
from fsw.core.fdir.sensors.health import SensorConfig
from fsw.core.gate.second_sender import SecondSenderConfig
from fsw.core.laws.interface import ControlConfig, Setpoint
from fsw.core.laws.plan.pulse_model import AXES
from fsw.core.laws.table import LAWS
from fsw.core.modes import TABLE, ModeConfig
from fsw.core.orbit.ephemeris import EphemerisModel, ephemeris_model
from fsw.core.orbit.field import FieldKind
from fsw.core.orbit.propagation import Orbit, circular_orbit, sgp4_orbit
from fsw.core.rates import RateGroup, RateTable
from fsw.input.schema import TableError
from fsw.table.calibration import calibration, coil_axes, own_field, stray_axes
from fsw.table.estimator import estimator_config, of_steps, plausibility_config
from fsw.table.own_law import with_own_law
from fsw.table.schedules import planned_pulses, schedules
from fsw.table.sections import CoilTable, ModesTable, OrbitTable, TelemetryTable
from fsw.table.table import FlightTable
from fsw.table.wheel import driven_wheel
from fsw.wire.coil_current import OFF_PART

CHATTER_S = 10.0
"""Longest time between signs of a second sender of reports."""
STUCK_S = 1.0
"""Time beyond a pulse after which a level or current that nobody asked for counts as stuck."""


def flight_config(table: FlightTable, source: str = "flight table") -> FlightConfig:
    """Prepare everything a step needs.

    Raises:
        TableError: the table is consistent but cannot be used (orbit decayed); the sentence names ``source``.
    """
    tick_hz = table.time.tick_hz
    try:
        orbit = _orbit(table.orbit, table.epoch_unix_s)
        estimator, timing = estimator_config(table), _pulses(table)
        return FlightConfig(
            tick_hz=tick_hz,
            epoch_unix_s=table.epoch_unix_s,
            table_crc=table.crc,
            ephemeris=_ephemeris(table, orbit),
            estimator=estimator,
            control=_control(table, orbit),
            coils=ActuatorConfig(timing, _dipoles(table)),
            read_back=ReadBackConfig(OFF_PART * table.coils.levels_ma[0], _stuck_ticks(table)),
            calibration=calibration(table.calibration),
            own_field=own_field(table.calibration.coils, table.coils, tick_hz),
            fdir=_fdir(table, timing, estimator.mekf),
            modes=_modes(table.modes, tick_hz),
            rates=_rates(table.telemetry, tick_hz),
            event_spacing_ticks=_ticks(table.fdir.event_spacing_s, tick_hz),
            second_sender=_second_sender(table),
            stale_after_ticks=max(1, _ticks(table.modes.stale_after_s, tick_hz)),
            wheel=driven_wheel(table.wheel, tick_hz),
        )
    except ValueError as error:
        raise TableError(f"{source}: {error}") from None


def onboard_ephemeris(table: FlightTable) -> EphemerisModel:
    """The onboard model of orbit, field and Sun alone; a user law is not executed for it.

    Raises:
        TableError: the orbit has no position at the epoch, or the field does not hold there.
    """
    try:
        return _ephemeris(table, _orbit(table.orbit, table.epoch_unix_s))
    except ValueError as error:
        raise TableError(f"flight table: {error}") from None


def _ephemeris(table: FlightTable, orbit: Orbit) -> EphemerisModel:
    return ephemeris_model(
        orbit,
        table.epoch_unix_s,
        table.time.tick_hz,
        FieldKind(table.field.model),
        table.field.degree,
        table.telemetry.ephemeris_s,
    )


def _orbit(orbit: OrbitTable, epoch_unix_s: int) -> Orbit:
    if orbit.tle is not None:
        return sgp4_orbit(*orbit.tle)
    altitude_km = orbit.altitude_km or 0.0
    return circular_orbit(altitude_km, orbit.inclination_deg, orbit.raan_deg, orbit.u0_deg, epoch_unix_s)


def _control(table: FlightTable, orbit: Orbit) -> ControlConfig:
    control, coils, inertia = table.control, table.coils, table.body.law_inertia
    gains = _gains(control.gains)
    if coils.driver == "continuous":
        mean_dipole_am2 = _full_scale(coils)
    else:
        mean_dipole_am2 = coils.levels_am2[2] * coils.pulse_s / (coils.pulse_s + coils.backoff_s)
    config = ControlConfig(
        setpoint=Setpoint(control.law_name, control.k_w, control.k_a, control.k_i, control.spin_radps),
        gains=gains,
        inertia_kgm2=inertia,
        inertia_inverse=inverse(inertia),
        wheel_body_nms=table.body.law_wheel_nms,
        pulsed=coils.driver == "pulsed",
        tick_s=1.0 / table.time.tick_hz,
        horizon_s=coils.pulse_s,
        mean_dipole_am2=mean_dipole_am2,
        schedules=schedules(table, orbit, gains),
        pulse_model=planned_pulses(table, orbit, gains, _pulses(table)),
        wheel=driven_wheel(table.wheel, table.time.tick_hz, table.body.law_axes),
        axes=table.body.law_axes,
    )
    return with_own_law(config, control) if control.own else config


def _gains(given: Mapping[str, Mapping[str, float]]) -> dict[str, Any]:
    """Each law's own gains: defaults except for those given, which the table has checked."""
    return {name: law.gains(**given.get(name, {})) for name, law in LAWS.items() if law.gains is not None}


def _dipoles(table: FlightTable) -> DipoleConfig | None:
    if table.coils.driver == "pulsed":
        return None
    genetic = table.control.minimiser == "genetic"
    columns = coil_axes(table.calibration.coils)
    matrices = (transpose(columns), inverse(transpose(columns))) if columns != AXES else (None, None)
    return DipoleConfig(_full_scale(table.coils), table.body.inertia, genetic, *matrices)


def _full_scale(coils: CoilTable) -> float:
    """The largest mean dipole over a tick of a continuous driver, A m^2."""
    return (coils.max_dipole_am2 or 0.0) * coils.on_fraction


def _fdir(table: FlightTable, timing: PulseConfig, mekf: MekfConfig) -> FdirConfig:
    given, tick_hz = table.fdir, table.time.tick_hz
    budget = weights(given.false_alarm_days, 1.0 / tick_hz, of_steps(table.estimator))
    return FdirConfig(
        plausibility=plausibility_config(table),
        sensors=SensorConfig(budget, credibility_config(mekf), mekf),
        coils=CoilHealthConfig(
            current_ma=table.coils.levels_ma,
            weak=weak_test(given.weak_coil_part, budget.threshold, mekf),
            stuck_ma=max(1.0, 0.5 * table.coils.levels_ma[0]),
            stuck_ticks=_stuck_ticks(table),
            pulses=timing,
            mekf=mekf,
            retest_ticks=_ticks(given.coil_retest_s, tick_hz),
            stray_axes=stray_axes(table.calibration.coils),
            left_ma_per_am2=_left_ma_per_am2(table),
        ),
    )


def _left_ma_per_am2(table: FlightTable) -> Vec3:
    """Of a continuous driver that need not be off when the sensors sample: only a filter needs that."""
    coils = table.coils
    if coils.driver == "pulsed" or table.knowledge == "filter":
        return ZERO
    ma_per_am2 = 1000.0 / (coils.dipole_per_ampere_am2 * coils.on_fraction)
    return scale(ma_per_am2, transform(inverse(stray_axes(table.calibration.coils)), (1.0, 1.0, 1.0)))


def _stuck_ticks(table: FlightTable) -> int:
    """Ticks from a request until nothing of its pulse flows any more."""
    return _ticks(table.coils.pulse_s + STUCK_S, table.time.tick_hz) + 1


def _second_sender(table: FlightTable) -> SecondSenderConfig:
    longest_s = table.fdir.second_sender_s
    return SecondSenderConfig(
        _ticks(longest_s, table.time.tick_hz), _ticks(min(CHATTER_S, longest_s), table.time.tick_hz)
    )


def _pulses(table: FlightTable) -> PulseConfig:
    coils, inverse_j = table.coils, inverse(table.body.inertia)
    tick_hz = table.time.tick_hz
    pulse_ticks, backoff_ticks, duration_ms = pulse_timing(
        tick_hz, int(coils.pulse_s * 1000.0 + 1e-6), ceil(coils.backoff_s * 1000.0 - 1e-6)
    )
    return PulseConfig(
        pulse_ticks=pulse_ticks,
        backoff_ticks=backoff_ticks,
        duration_ms=duration_ms,
        shared=coils.shared,
        levels_am2=coils.levels_am2,
        pulse_s=duration_ms / 1000.0,
        tick_s=1.0 / tick_hz,
        leak_s=table.control.leak_s,
        rate_metric=product(inverse_j, inverse_j),
        energy_metric=inverse_j,
        coil_axes=coil_axes(table.calibration.coils),
    )


def _modes(modes: ModesTable, tick_hz: int) -> ModeConfig:
    dwell_s = {
        "none_s": 0.0,
        "recover_s": modes.recover_s,
        "settle_s": modes.settle_s,
        "lose_s": modes.lose_s,
        "hold_s": modes.hold_s,
    }
    return ModeConfig(
        dwell_ticks=tuple(_ticks(dwell_s[row.dwell], tick_hz) for row in TABLE),
        slow_radps=radians(modes.slow_degps),
        fast_radps=radians(modes.fast_degps),
        near_cosine=cos(radians(modes.near_deg)),
        far_cosine=cos(radians(modes.far_deg)),
        axis_only=modes.axis_only,
        trips_to_stay_safe=modes.trips_to_stay_safe,
    )


def _ticks(seconds: float, tick_hz: int) -> int:
    """Ticks lasting at least this long; 1.1 s at 10 Hz are 11, though 1.1 * 10 is slightly more in floats."""
    return ceil(seconds * tick_hz - 1e-9)


def _rates(telemetry: TelemetryTable, tick_hz: int) -> RateTable:
    def every(period_s: float) -> RateGroup:
        return RateGroup(max(1, round(period_s * tick_hz)))

    return RateTable(
        attitude=every(telemetry.attitude_s),
        quality=every(telemetry.quality_s),
        parameter=every(telemetry.parameter_s),
        heartbeat=every(telemetry.heartbeat_s),
    )
