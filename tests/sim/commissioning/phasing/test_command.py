"""The command: what it refuses, and how long the sequence takes."""

import pytest

from sim.commissioning.phasing.command import BenchSetUp, of_log, on_bench, sequence_ticks, with_sequence
from sim.commissioning.phasing.judge import Known
from sim.errors import HarnessError
from sim.scenario.schema import load


def test_on_a_bench_nothing_is_driven_without_arm():
    with pytest.raises(HarnessError, match="allow it by --arm"):
        on_bench(load("microsat"), 1, 1, Known(), BenchSetUp("loop", frozenset(), False), None)


def test_continuous_coils_have_no_pulses():
    continuous = load("microsat", {"coils": {"driver": "continuous", "max_dipole_am2": 5.0}})
    with pytest.raises(HarnessError, match="phasing needs pulsed coils"):
        with_sequence(continuous, 1)


def test_a_log_alone_needs_its_scenario(tmp_path):
    log = tmp_path / "bus.log"
    log.write_text("(1.000000) vcan0 180#00\n")
    with pytest.raises(HarnessError, match="name its scenario by --scenario"):
        of_log(log, None, {}, Known())


def test_the_sequence_has_time_for_each_coil_in_both_polarities():
    shared, per_coil = load("microsat"), load("microsat", {"coils": {"backoff": "per_coil"}})
    assert sequence_ticks(shared, 1) >= 100 + 6 * 103
    assert sequence_ticks(shared, 2) - sequence_ticks(shared, 1) >= 6 * 103
    assert sequence_ticks(per_coil, 1) < sequence_ticks(shared, 1)
    assert sequence_ticks(shared, 1, at_rest=True) < sequence_ticks(shared, 1)
