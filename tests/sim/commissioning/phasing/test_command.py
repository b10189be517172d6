"""The command: what it refuses, and how long the sequence takes."""

import pytest
from click.testing import CliRunner

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import Sync
from sim.commissioning.phasing.command import BenchSetUp, of_log, on_bench, sequence_ticks, with_sequence
from sim.commissioning.phasing.judge import PhasingPremises
from sim.errors import HarnessError
from sim.scenario.schema import load
from torquer.cli.main import main


def test_on_a_bench_nothing_is_driven_without_arm():
    with pytest.raises(HarnessError, match="allow it by --arm"):
        on_bench(load("microsat"), 1, 1, PhasingPremises(), BenchSetUp("loop", frozenset(), False), None)


def test_continuous_coils_have_no_pulses():
    continuous = load("microsat", {"coils": {"driver": "continuous", "max_dipole_am2": 5.0}})
    with pytest.raises(HarnessError, match="phasing needs pulsed coils"):
        with_sequence(continuous, 1)


def test_a_log_alone_needs_its_scenario(tmp_path):
    log = tmp_path / "bus.log"
    log.write_text("(1.000000) vcan0 180#00\n")
    with pytest.raises(HarnessError, match="name its scenario by --scenario"):
        of_log(log, None, {}, PhasingPremises())


def test_the_sequence_has_time_for_each_coil_in_both_polarities():
    shared, per_coil = load("microsat"), load("microsat", {"coils": {"backoff": "per_coil"}})
    assert sequence_ticks(shared, 1) >= 100 + 6 * 103
    assert sequence_ticks(shared, 2) - sequence_ticks(shared, 1) >= 6 * 103
    assert sequence_ticks(per_coil, 1) < sequence_ticks(shared, 1)
    assert sequence_ticks(shared, 1, at_rest=True) < sequence_ticks(shared, 1)


@pytest.mark.parametrize("tick_hz", [1, 10])
def test_on_a_bench_the_last_pulse_is_followed_for_as_long_at_any_rate(tick_hz):
    scenario = load("microsat", {"time": {"tick_hz": tick_hz}})
    flown, at_rest = (sequence_ticks(scenario, 1, resting) / tick_hz for resting in (False, True))
    assert flown - at_rest == pytest.approx(100.0 + 30.0 - 20.0, abs=1.0)


def run(*arguments):
    return CliRunner().invoke(main, ["phasing", *map(str, arguments)])


def test_a_log_of_a_time_without_a_field_model_is_named(tmp_path):
    log = tmp_path / "late.log"
    log.write_text(
        "".join(
            format_line(format_time(tick * 10**6), "can0", Sync(tick, 2_000_000_000 + tick).encode())
            for tick in range(10)
        )
    )
    result = run(log, "--scenario", "microsat")
    assert (result.exit_code, result.stdout) == (2, "")
    assert f"{log}: the log is of 2033-05-18 03:33:20 to 2033-05-18 03:33:29 UTC" in result.stderr
    assert "the IGRF-14 table covers 1900 to 2030" in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("--bus", "loop", "--arm"), "--bus, --arm"),
        (("--real", "coil"), "--real"),
        (("--scenario", "microsat", "--set", "coils.backoff=shared"), "--scenario, --set"),
        (("--at-rest", "--field-nt", "1", "2", "3"), "--at-rest, --field-nt"),
        (("--rounds", "1", "--seed", "1", "--out", "kept"), "--rounds, --seed, --out"),
        (("--offset-nt", "1000", "--coil-field-nt-per-am2", "5"), "--offset-nt, --coil-field-nt-per-am2"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_has_no_effect_on_a_bench_log_is_refused(bench_csv, tmp_path, monkeypatch, words, named):
    monkeypatch.chdir(tmp_path)
    result = run(bench_csv, *words)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == (
        f"torquer: {named}: {bench_csv} is a recorded bench log, which is judged by itself\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_a_bench_log_is_judged_and_the_document_may_be_asked_for(bench_csv):
    assert run(bench_csv, "--json", "--quiet").exit_code == 0


def test_neither_is_a_log_flown_again_nor_a_simulation_armed(tmp_path):
    log = tmp_path / "bus.log"
    log.touch()
    result = run(log, "--arm", "--seed", "2")
    assert result.exit_code == 2
    assert "--arm, --seed: a log is judged as it is; name a SCENARIO to fly or for a bench" in result.stderr
    result = run("microsat", "--real", "coil", "--arm")
    assert result.exit_code == 2
    assert "--real, --arm: without --bus the SCENARIO is flown in simulation" in result.stderr
