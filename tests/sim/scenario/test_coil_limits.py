"""One table of coils, from which scheduler, boards and auditor each take the same limits."""

import pytest

from fsw.table.config import flight_config
from hil_stub.coils.interlock import CoilLimits
from sim.audit.limits import limits_in
from sim.scenario.coil_limits import coil_limits
from sim.scenario.schema import flight_table, load, shipped


@pytest.mark.parametrize("backoff", ["shared", "per_coil"])
def test_the_limits_of_the_board_are_those_of_the_table(backoff):
    scenario = load(
        "microsat",
        {"coils": {"pulse_s": 2.5, "backoff_s": 7.25, "backoff": backoff}, "time": {"tick_hz": 10}},
    )
    assert coil_limits(scenario.coils, scenario.time.tick_hz) == CoilLimits(
        tick_hz=10, pulse_ms=2500, backoff_ms=7250, shared=backoff == "shared"
    )


@pytest.mark.parametrize("scenario", shipped(), ids=lambda scenario: scenario.name)
def test_scheduler_board_and_auditor_agree(scenario):
    board = coil_limits(scenario.coils, scenario.time.tick_hz)
    pulses = flight_config(flight_table(scenario)).coils.pulses
    audited = limits_in(scenario.model_dump(mode="json"), scenario.name)
    assert pulses.shared == board.shared == audited.shared
    assert 1000 * pulses.duration_ms == 1000 * board.pulse_ms == audited.pulse_us
    assert 1000 * board.backoff_ms == audited.backoff_us
    assert pulses.backoff_ticks * 1000 >= board.backoff_ms * board.tick_hz
