"""What a scenario says that is allowed and most likely wrong, each a sentence with what may be meant."""

from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from math import ceil, hypot, pi

import numpy as np

from fsw.core.commands import HANDLERS, Situation
from fsw.core.orbit.tle import tle_elements
from fsw.core.step import boot
from fsw.input.schema import TableError
from fsw.table.calibration import MagnetometerTable
from fsw.table.config import flight_config
from fsw.table.estimator import table_bounds
from fsw.table.sections import CIRCULAR_KEYS
from fsw.table.uncertainty import ROUNDING
from fsw.wire.messages import TcAckResult, TcGain, TcLaw, TcOrbitElement, TcParameter, TcSpin
from sim.design.from_scenario import body_of
from sim.flight.record_flight import ticks_of
from sim.scenario.assemble import plant_config
from sim.scenario.residual_errors import reading_of
from sim.scenario.schema import Scenario, flight_table
from sim.scenario.sections import ScenarioCoils, ScenarioOrbit, SunSensorSection
from sim.scenario.telecommands import unsent_telecommands
from sim.sizing.deviations import deviations, slight_disturbance
from sim.sizing.expectation import field_across, torque_balance
from sim.sizing.gravity import gravity_on, gravity_words
from sim.sizing.levels import TOO_WEAK, levels_against, levels_for
from sim.sizing.torques import orbit_nodes, surface_torque

# --- Faults of a scenario that a run is too short for


def unbegun_faults(scenario: Scenario, ticks: int) -> list[str]:
    """A sentence for each fault that does not begin in so many ticks: its first tick is after the last."""
    tick_hz = scenario.time.tick_hz
    return [
        f"fault[{place}], {fault.kind} at {fault.at_s:g} s, will not begin: "
        f"the last tick is at {(ticks - 1) / tick_hz:g} s"
        for place, fault in enumerate(scenario.fault)
        if ceil(fault.at_s * tick_hz) >= ticks
    ]


# --- Keys of a scenario that say something of a part that the satellite does not have


def ignored_keys(scenario: Scenario) -> list[str]:
    """A sentence for each group of keys that differ from their defaults and have no effect."""
    found = []
    sun, usual = scenario.sensors.sun, SunSensorSection()
    named = [key for key in SunSensorSection.model_fields if getattr(sun, key) != getattr(usual, key)]
    if scenario.sensors.cells is not None and named:
        keys = ", ".join(f"sensors.sun.{key}" for key in named)
        found.append(f"{keys}: of no effect, sensors.cells stands in place of the Sun sensor")
    coils = scenario.coils
    if coils.driver == "pulsed" and coils.on_fraction != ScenarioCoils.model_fields["on_fraction"].default:
        found.append(
            f"coils.on_fraction = {coils.on_fraction:g} is of no effect, the driver is pulsed: "
            'coils.driver = "continuous" drives for a part of each tick'
        )
    orbit, circle = scenario.orbit, ScenarioOrbit.model_fields
    beside = [key for key in CIRCULAR_KEYS if getattr(orbit, key) != circle[key].default]
    if orbit.tle is not None and beside:
        keys = ", ".join(f"orbit.{key}" for key in beside)
        found.append(f"{keys}: of no effect, the elements of orbit.tle are flown; leave out one or the other")
    return found


# --- Values that are probably wrong

DAY_S = 86400.0
OLD_TLE_DAYS = 366.0
"""A TLE is good for days; what is a year from its epoch is another year's."""
WILD_STEP, FAINT_STEP = 30.0, 1e-3
"""Change of rate by a pulse of the strongest level, in orbital rates: 0.1 to 0.5 in a sound design."""
STRONGEST_AM2 = 1000.0
FASTEST_DEGPS = 30.0
LEAST_INCLINATION_DEG = 10.0
NOISE_NT, NOISE_DEG = (1.0, 5000.0), (1e-3, 10.0)
"""Plausible noise of a magnetometer and of a Sun sensor; none at all is a deliberate choice."""
LEAST_TIMES = 2.5
"""The bound of the torque over drag and light, half of what lets the filter follow them along the orbit."""
LARGEST_M = 20.0
"""How far from the mass centre a plate may be, and its edge."""
LEAST_CURRENT_MA, MOST_CURRENT_MA = 1.0, 10_000.0
SAME_AT_ANY_TIME = (TcLaw, TcGain, TcSpin, TcOrbitElement, TcParameter)
"""Telecommands that are refused for what they say, not for the state of the satellite."""


def scenario_warnings(scenario: Scenario, ticks: int | None = None) -> list[str]:
    """The doubts, in the order of the sections of a scenario; none for one that is plausible.

    A run of it takes so many ticks; None: as the scenario says.
    """
    found = [doubt for judge in _JUDGES for doubt in judge(scenario)]
    if _has_an_orbit(scenario):
        found += [doubt for judge in _JUDGES_OF_AN_ORBIT for doubt in judge(scenario)]
    flown = ticks_of(scenario, None) if ticks is None else ticks
    found += ignored_keys(scenario)
    found += unsent_telecommands(scenario.telecommand, scenario.time.tick_hz, flown)
    return found + unbegun_faults(scenario, flown)


def _epoch(scenario: Scenario) -> Iterator[str]:
    if scenario.orbit.tle is None:
        return
    elements = tle_elements(*scenario.orbit.tle)
    tle_s = DAY_S * (elements.epoch_day + elements.epoch_fraction)
    days = (scenario.epoch_unix_s - tle_s) / DAY_S
    if abs(days) > OLD_TLE_DAYS:
        dates = (f"{datetime.fromtimestamp(when, UTC):%Y-%m-%d}" for when in (tle_s, scenario.epoch_unix_s))
        yield (
            "orbit.tle is of {} and the flight begins on {}, {:.1f} years {}: elements are good for days; "
            "leave out time.epoch_utc to begin at theirs".format(
                *dates, abs(days) / 365.25, "later" if days > 0.0 else "earlier"
            )
        )


def _orbit(scenario: Scenario) -> Iterator[str]:
    inclination_deg = body_of(scenario).inclination_deg
    given = scenario.orbit.tle is not None or "inclination_deg" in scenario.orbit.model_fields_set
    left_out = "" if given else "; where the key is left out it is 0"
    if min(inclination_deg, 180.0 - inclination_deg) < LEAST_INCLINATION_DEG:
        radians_asked = "; is it in deg, not in rad?" if 0.0 < inclination_deg <= pi else ""
        yield (
            f"orbit.inclination_deg = {inclination_deg:g}: over the equator the field hardly turns, and "
            f"coils cannot turn the satellite about it{left_out}{radians_asked}"
        )


def _step(scenario: Scenario) -> Iterator[str]:
    """Change of rate of the heaviest axis by the strongest pulse, in orbital rates."""
    body, coils = body_of(scenario), scenario.coils
    heaviest = float(np.linalg.eigvalsh(np.asarray(body.inertia_kgm2))[-1])
    driven_s = coils.pulse_s if coils.driver == "pulsed" else coils.on_fraction * coils.pulse_s
    step = coils.largest_am2 * field_across(body) * driven_s / (heaviest * body.rate_radps)
    key = "coils.levels_am2" if coils.driver == "pulsed" else "coils.max_dipole_am2"
    change = f"{driven_s:g} s of the strongest dipole change the rate by {step:.2g} orbital rates"
    if step > WILD_STEP:
        yield (
            f"{change}: body.inertia_kgm2 is too small for {key}; is it in kg m^2, and the dipole in A m^2, "
            "not in mA m^2?"
        )
    elif step < FAINT_STEP:
        yield (
            f"{change}: body.inertia_kgm2 is too large for {key}; is it in kg m^2, not in g m^2 (1000 times "
            "as much) or kg mm^2 (10^6 times)?"
        )


def _coils(scenario: Scenario) -> Iterator[str]:
    strongest = levels_for(body_of(scenario), scenario.coils.pulse_s)[2]
    if scenario.coils.driver == "pulsed" and strongest > STRONGEST_AM2:
        yield (
            f"body.inertia_kgm2 asks for coils of {strongest:.0f} A m^2, and those of satellites have up to "
            f"{STRONGEST_AM2:g}: is it in kg m^2?"
        )


def _load(scenario: Scenario) -> Iterator[str]:
    if scenario.coils.driver != "pulsed" or gravity_on(scenario).rests_elsewhere:
        return
    balance = torque_balance(scenario)
    if balance.load > TOO_WEAK:
        high = levels_against(scenario, balance.load)[2]
        yield (
            f"balancing the disturbance of {balance.disturbance_nm:.2g} N m takes "
            f"{balance.load:.0%} of what coils.levels_am2 can give in pulses: too weak to point with; "
            f"a strongest level of {high:g} A m^2 would do"
        )


def _gravity(scenario: Scenario) -> Iterator[str]:
    gravity = gravity_on(scenario)
    if gravity.away or gravity.rests_elsewhere:
        yield f"gravity {gravity_words(gravity)}"


def _ticks(scenario: Scenario) -> Iterator[str]:
    tick_hz, coils = scenario.time.tick_hz, scenario.coils
    for name, value_s, becomes in (
        ("pulse_s", coils.pulse_s, "shorter"),
        ("backoff_s", coils.backoff_s, "longer"),
    ):
        ticks = value_s * tick_hz
        if coils.driver == "pulsed" and abs(ticks - round(ticks)) > 1e-9:
            yield (
                f"coils.{name} = {value_s:g} is not a whole number of ticks of {1.0 / tick_hz:g} s: the "
                f"scheduler makes it {becomes}"
            )
    cycle_s = coils.pulse_s + coils.backoff_s
    if coils.driver == "pulsed" and scenario.control.leak_s < cycle_s:
        yield (
            f"control.leak_s = {scenario.control.leak_s:g} is less than the {cycle_s:g} s from one pulse to "
            "the next: what the law demands is forgotten before a coil may pay it"
        )


def _currents(scenario: Scenario) -> Iterator[str]:
    low, _, high = scenario.coils.levels_ma
    if low < LEAST_CURRENT_MA or high > MOST_CURRENT_MA:
        yield (
            f"coils.dipole_per_ampere_am2 = {scenario.coils.dipole_per_ampere_am2:g} makes the levels "
            f"{low:.3g} to {high:.3g} mA: coils take some 10 mA to 1 A; is it A m^2 per A?"
        )


def _sensors(scenario: Scenario) -> Iterator[str]:
    if scenario.knowledge == "perfect":
        return
    magnetometer, sun = scenario.sensors.magnetometer, scenario.sensors.sun
    for key, value, (least, most), unit in (
        ("magnetometer.noise_nt", magnetometer.noise_nt, NOISE_NT, "nT"),
        ("sun.noise_deg", sun.noise_deg, NOISE_DEG, "deg"),
    ):
        if value > most or 0.0 < value < least:
            much = "noisier" if value > most else "better"
            yield (
                f"sensors.{key} = {value:g} is {much} than such a sensor is, {least:g} to {most:g}: "
                f"is it in {unit}?"
            )
    strongest_nt = 1e9 * 2.0 * body_of(scenario).field_t
    sensed, offset_t = reading_of(plant_config(scenario, seed=0).magnetometer)
    largest_nt = float(np.max(strongest_nt * np.linalg.norm(sensed, axis=1) + 1e9 * np.abs(offset_t)))
    if magnetometer.saturation_nt < largest_nt:
        yield (
            f"sensors.magnetometer.saturation_nt = {magnetometer.saturation_nt:g} is less than "
            f"{largest_nt:.0f} nT, the field over the poles of this orbit and the sensor's offset"
        )
    known = flight_table(scenario).calibration.magnetometer or MagnetometerTable()
    counts = known.range_nt is not None or magnetometer.saturation_nt < largest_nt
    if counts and known.most_nt != magnetometer.saturation_nt:
        yield (
            f"flight.calibration.magnetometer.range_nt = {known.most_nt:g} is not the sensor's, "
            f"sensors.magnetometer.saturation_nt = {magnetometer.saturation_nt:g}: an axis at its end is "
            "taken for a fault, or a fault for that"
        )


def _sizes(scenario: Scenario) -> Iterator[str]:
    view_deg = scenario.sensors.sun.fov_half_deg
    if view_deg is not None and view_deg <= pi:
        yield f"sensors.sun.fov_half_deg = {view_deg:g} is a narrow view: is it in deg, not in rad?"
    for number, plate in enumerate(scenario.body.plates):
        for key, value, most, unit in (
            ("area_m2", plate.area_m2, LARGEST_M**2, "m^2"),
            ("centre_m", hypot(*plate.centre_m), LARGEST_M, "m"),
        ):
            if value > most:
                yield (
                    f"body.plates: plate {number} has {key} = {value:g}, and coils turn satellites of some "
                    f"metres: is it in {unit}?"
                )


def _start(scenario: Scenario) -> Iterator[str]:
    rate_degps = hypot(*scenario.initial.rate_degps)
    if rate_degps > FASTEST_DEGPS:
        yield f"initial.rate_degps is {rate_degps:.3g} deg/s, which coils take days to stop: is it in deg/s?"


def _beyond_bounds(scenario: Scenario) -> Iterator[str]:
    """What the satellite is differs from what the onboard table says by more than its bound admits."""
    if scenario.knowledge == "perfect":
        return
    for one in deviations(scenario, table_bounds(flight_table(scenario))):
        if one.worst > max(one.bound * (1.0 + ROUNDING), one.slight):
            yield f"{one.words}: the filter is not made for it"


def _drag_and_light(scenario: Scenario) -> Iterator[str]:
    """They change along the orbit, faster than the filter may follow by that bound."""
    if scenario.knowledge == "perfect" or not scenario.body.plates:
        return
    known = table_bounds(flight_table(scenario))
    peak_nm = float(np.abs(surface_torque(scenario, orbit_nodes(scenario))).max())
    if LEAST_TIMES * peak_nm > max(known.torque_nm, slight_disturbance(scenario)[1]):
        yield (
            f"disturbance.drag and .solar_pressure reach {peak_nm:.2g} N m on body.plates, and "
            f"flight.uncertainty.torque_nm = {known.torque_nm:.2g}: the filter follows what changes along "
            f"the orbit by a bound of five times that, {5.0 * peak_nm:.2g}"
        )


def _telecommands(scenario: Scenario) -> Iterator[str]:
    """The flight software is asked for its answer, as it is at boot."""
    if not scenario.telecommand:
        return
    config = flight_config(flight_table(scenario))
    situation = Situation(None, config)
    for place, telecommand in enumerate(scenario.telecommand):
        for message in telecommand.messages():
            if isinstance(message, SAME_AT_ANY_TIME):
                answer = HANDLERS[type(message)](boot(config), message, situation)
                if answer is not TcAckResult.ACCEPTED:
                    yield (
                        f"telecommand[{place}], {telecommand.message} at {telecommand.at_s:g} s, will be "
                        f"answered {answer.name.lower()!r}: {_ANSWERS[answer]}"
                    )


_ANSWERS = {
    TcAckResult.UNKNOWN: "the satellite has no such law, or not what it needs",
    TcAckResult.OUT_OF_RANGE: "the value is beyond what the flight software takes",
    TcAckResult.NOT_ALLOWED: "its filter does not estimate that parameter",
}

_JUDGES: tuple[Callable[[Scenario], Iterator[str]], ...] = (
    _epoch,
    _orbit,
    _step,
    _coils,
    _start,
    _ticks,
    _currents,
    _sensors,
    _sizes,
    _gravity,
    _beyond_bounds,
    _telecommands,
)
_JUDGES_OF_AN_ORBIT: tuple[Callable[[Scenario], Iterator[str]], ...] = (_load, _drag_and_light)


def _has_an_orbit(scenario: Scenario) -> bool:
    """Whether elements and field hold for an orbit: a shorter flight flies without."""
    try:
        orbit_nodes(scenario)
    except TableError:
        return False
    return True
