"""``torquer fsw``: the flight software by hand, with the onboard table of a scenario."""

import pytest

from fsw.wire.messages import FswBoot, PlantEnd, Sync, TickDone
from sim.scenario.schema import flight_table, load, parse_settings


@pytest.mark.long
@pytest.mark.parametrize("settings", [(), ("time.tick_hz=2", "coils.backoff=per_coil")])
def test_it_flies_the_table_of_the_scenario_with_settings_laid_over_it(bus, start, settings):
    scenario = load("posat1", parse_settings(settings))
    words = [word for setting in settings for word in ("--set", setting)]
    node = start("fsw", "posat1", *words)
    boot = bus.receive(120.0)
    assert boot.can_id == FswBoot.ID
    assert FswBoot.decode(boot.data).table_crc == flight_table(scenario).crc
    bus.send([Sync(0, scenario.epoch_unix_s).encode()])
    while (frame := bus.receive(120.0)).can_id != TickDone.ID:
        pass
    assert TickDone.decode(frame.data).tick == 0
    bus.send([PlantEnd(1).encode()])
    assert node.wait() == (0, f"fsw on {bus.spec}\n")
