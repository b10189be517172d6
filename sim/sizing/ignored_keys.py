"""Keys of a scenario that say something of a part that the satellite does not have."""

from fsw.table.sections import CIRCULAR_KEYS
from sim.scenario.schema import Scenario
from sim.scenario.sections import ScenarioCoils, ScenarioOrbit, SunSensorSection


def ignored_keys(scenario: Scenario) -> list[str]:
    """A sentence for each group of keys that differ from their defaults and have no effect."""
    told = []
    sun, usual = scenario.sensors.sun, SunSensorSection()
    named = [key for key in SunSensorSection.model_fields if getattr(sun, key) != getattr(usual, key)]
    if scenario.sensors.cells is not None and named:
        keys = ", ".join(f"sensors.sun.{key}" for key in named)
        told.append(f"{keys}: of no effect, sensors.cells stands in place of the Sun sensor")
    coils = scenario.coils
    if coils.driver == "pulsed" and coils.on_fraction != ScenarioCoils.model_fields["on_fraction"].default:
        told.append(
            f"coils.on_fraction = {coils.on_fraction:g} is of no effect, the driver is pulsed: "
            'coils.driver = "continuous" drives for a part of each tick'
        )
    orbit, circle = scenario.orbit, ScenarioOrbit.model_fields
    beside = [key for key in CIRCULAR_KEYS if getattr(orbit, key) != circle[key].default]
    if orbit.tle is not None and beside:
        keys = ", ".join(f"orbit.{key}" for key in beside)
        told.append(f"{keys}: of no effect, the elements of orbit.tle are flown; leave out one or the other")
    return told
