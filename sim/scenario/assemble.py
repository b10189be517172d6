"""The plant's configuration and effects from a scenario, units converted to SI."""

from math import cos, hypot, radians, sin

from fsw.core.algebra.quaternion import conjugate, multiply
from fsw.input.schema import TableError
from fsw.table.sections import CoilTable
from hil_stub.coils.interlock import CoilLimits
from sim.plant.config import (
    BodyConfig,
    CoilConfig,
    ContinuousConfig,
    DisturbanceConfig,
    FieldConfig,
    InitialConfig,
    OrbitConfig,
    PlantConfig,
    PlateConfig,
)
from sim.plant.own_effects import OwnEffects
from sim.plant.sensor_config import AS_NAMED, CellConfig, MagnetometerConfig, SunCellsConfig, SunSensorConfig
from sim.plant.wheel_config import WheelConfig
from sim.scenario.own_effects import own_effects
from sim.scenario.schema import Scenario, orbit_period_s
from sim.scenario.sections import CellsSection, ScenarioWheel
from sim.value_types import Vec3

NT = 1e-9


def plant_config(scenario: Scenario, seed: int) -> PlantConfig:
    """The plant of a scenario, its random streams drawn from ``seed``.

    Raises:
        TableError: the scenario is consistent in itself, but no plant can have these numbers.
    """
    try:
        return _config(scenario, seed)
    except ValueError as error:
        raise TableError(f"scenario {scenario.name}: the plant: {error}") from None


def _config(scenario: Scenario, seed: int) -> PlantConfig:
    tick_hz, cells = scenario.time.tick_hz, scenario.sensors.cells
    return PlantConfig(
        epoch_unix_s=scenario.epoch_unix_s,
        tick_hz=tick_hz,
        seed=seed,
        orbit=_orbit(scenario),
        field=FieldConfig(scenario.field.model, scenario.field.degree, scenario.field.storm_nt * NT),
        body=_body(scenario),
        initial=initial_config(scenario),
        disturbance=_disturbance(scenario),
        magnetometer=_magnetometer(scenario),
        sun_sensor=_sun_sensor(scenario) if cells is None else _sun_cells(cells),
        coils=coil_config(scenario),
        limits=coil_limits(scenario.coils, tick_hz),
        max_substep_s=scenario.plant.max_substep_s,
        perfect_knowledge=scenario.knowledge == "perfect",
        wheel=None if scenario.wheel is None else _wheel(scenario.wheel),
    )


def _orbit(scenario: Scenario) -> OrbitConfig:
    orbit = scenario.orbit
    along_track_m = 1000.0 * orbit.along_track_km
    if orbit.tle is not None:
        return OrbitConfig(tle=orbit.tle, along_track_m=along_track_m)
    return OrbitConfig(
        altitude_m=1000.0 * (orbit.altitude_km or 0.0),
        inclination_rad=radians(orbit.inclination_deg),
        raan_rad=radians(orbit.raan_deg),
        u0_rad=radians(orbit.u0_deg),
        along_track_m=along_track_m,
    )


def _body(scenario: Scenario) -> BodyConfig:
    body = scenario.body
    plates = tuple(
        PlateConfig(
            plate.area_m2,
            _unit(plate.normal),
            plate.centre_m,
            plate.drag_coefficient,
            plate.specular,
            plate.diffuse,
        )
        for plate in body.plates
    )
    return BodyConfig(body.inertia, body.wheel_nms, plates)


def _wheel(section: ScenarioWheel) -> WheelConfig:
    friction = section.friction_scale
    return WheelConfig(
        _unit(section.axis),
        section.inertia_kgm2,
        section.max_torque_nm,
        section.max_momentum_nms,
        friction * section.viscous_nms,
        friction * section.coulomb_nm,
        section.time_constant_s,
        section.torque_scale,
        section.momentum_nms,
    )


def _disturbance(scenario: Scenario) -> DisturbanceConfig:
    section = scenario.disturbance
    return DisturbanceConfig(
        torque_body_nm=section.torque_nm,
        residual_dipole_body_am2=section.residual_dipole_am2,
        density_scale=section.drag.density_scale if section.drag else None,
        solar_flux_wpm2=section.solar_pressure.flux_wpm2 if section.solar_pressure else None,
        eddy_nms_per_t2=section.eddy_nms_per_t2,
        torque_noise_nm_rts=section.torque_noise_nm_rts,
        torque_daily_part=section.torque_daily_part,
        residual_dipole_eclipse_body_am2=section.residual_dipole_eclipse_am2,
        penumbra_torque_body_nm=section.penumbra_torque_nm,
    )


def effects_of(scenario: Scenario) -> OwnEffects:
    """The user effects of a scenario; their sources are executed.

    Raises:
        TableError: as for ``own_effects``.
    """
    return own_effects(scenario.effect, with_cells=scenario.sensors.cells is not None)


def coil_config(scenario: Scenario) -> CoilConfig:
    """The physics of a scenario's coils."""
    coils = scenario.coils
    first, second, third = coils.misalignment_deg
    continuous = None
    if coils.driver == "continuous" and coils.max_dipole_am2 is not None:
        continuous = ContinuousConfig(coils.max_dipole_am2, coils.on_fraction)
    return CoilConfig(
        coils.levels_am2,
        coils.dipole_per_ampere_am2,
        coils.time_constant_s,
        coils.dipole_scale,
        continuous,
        (_radians(first), _radians(second), _radians(third)),
        scenario.disturbance.remanence_part,
        coils.wiring or AS_NAMED,
    )


def initial_config(scenario: Scenario) -> InitialConfig:
    """Attitude and rate at tick 0: the nominal attitude, turned in the body."""
    initial = scenario.initial
    half = 0.5 * radians(initial.angle_deg)
    factor = sin(half) / hypot(*initial.axis)
    x, y, z = initial.axis
    q_body_from_orbit = (cos(half), factor * x, factor * y, factor * z)
    axes = scenario.body.law_axes
    if axes is not None:
        q_body_from_orbit = multiply(conjugate(axes.q_law_from_body), q_body_from_orbit)
    return InitialConfig(q_body_from_orbit, _radians(initial.rate_degps))


def _magnetometer(scenario: Scenario) -> MagnetometerConfig:
    section = scenario.sensors.magnetometer
    first, second, third = section.coil_field_nt_per_am2
    return MagnetometerConfig(
        noise_t=section.noise_nt * NT,
        bias_t=_scaled(section.bias_nt, NT),
        orbit_bias_t=_scaled(section.orbit_bias_nt, NT),
        orbit_bias_phase_rad=_radians(section.orbit_bias_phase_deg),
        orbit_s=orbit_period_s(scenario),
        shadow_bias_t=_scaled(section.shadow_bias_nt, NT),
        scale=section.scale,
        misalignment_rad=_radians(section.misalignment_deg),
        non_orthogonality_rad=_radians(section.non_orthogonality_deg),
        quantum_t=section.quantum_nt * NT,
        saturation_t=section.saturation_nt * NT,
        coil_coupling_t_per_am2=(_scaled(first, NT), _scaled(second, NT), _scaled(third, NT)),
        latency_s=section.latency_s,
        wiring=section.wiring or AS_NAMED,
    )


def _sun_sensor(scenario: Scenario) -> SunSensorConfig:
    section = scenario.sensors.sun
    return SunSensorConfig(
        noise_rad=radians(section.noise_deg),
        misalignment_rad=_radians(section.misalignment_deg),
        quantum=section.quantum,
        latency_s=section.latency_s,
        fov_half_rad=radians(section.fov_half_deg or 180.0),
        boresights_body=tuple(_unit(axis) for axis in section.boresights),
        albedo=section.albedo,
        albedo_spread=section.albedo_spread,
    )


def _sun_cells(section: CellsSection) -> SunCellsConfig:
    count = len(section.normals)
    gains, turns = section.gain or (1.0,) * count, section.turn_deg or ((0.0, 0.0, 0.0),) * count
    each = zip(section.normals, gains, turns, strict=True)
    return SunCellsConfig(
        cells=tuple(
            CellConfig(_unit(normal), gain, _radians(turn_deg), _shades(section, number))
            for number, (normal, gain, turn_deg) in enumerate(each, start=1)
        ),
        noise=0.01 * section.noise_percent,
        quantum=0.01 * section.quantum_percent,
        threshold=0.01 * section.threshold_percent,
        albedo=section.albedo,
        albedo_spread=section.albedo_spread,
        latency_s=section.latency_s,
    )


def _shades(section: CellsSection, number: int) -> tuple[tuple[Vec3, float], ...]:
    of_cell = [shade for shade in section.shades if shade.cell == number]
    return tuple((_unit(shade.axis), cos(radians(shade.half_deg))) for shade in of_cell)


def _scaled(v: Vec3, factor: float) -> Vec3:
    return (v[0] * factor, v[1] * factor, v[2] * factor)


def _unit(v: Vec3) -> Vec3:
    return _scaled(v, 1.0 / hypot(*v))


def _radians(v: Vec3) -> Vec3:
    return (radians(v[0]), radians(v[1]), radians(v[2]))


# --- The limits of a coil driver board, from the table of the coils: for plant, bench, faults and tools


def coil_limits(coils: CoilTable, tick_hz: int) -> CoilLimits:
    """What the interlock enforces; the times to the nearest millisecond.

    The scheduler takes its own limits from the same table, rounded to whole ticks (``fsw.table.config``), so
    that neither relies on the arithmetic of the other.
    """
    return CoilLimits(
        tick_hz=tick_hz,
        pulse_ms=round(1000.0 * coils.pulse_s),
        backoff_ms=round(1000.0 * coils.backoff_s),
        shared=coils.shared,
    )
