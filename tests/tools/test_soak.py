"""The long run in a short form: flight, judgement, page; and each broken budget is found."""

import json

import pytest
import soak

from fsw.wire.messages import CoilRefused
from sim.bench import command
from sim.bench.budgets import Budgets, judge
from sim.bench.realtime_loop import BenchMeasurements, TimeHistogram
from torquer.cli import main as cli


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    folder = tmp_path_factory.mktemp("soak") / "flight"
    soak.fly(folder, "microsat", 0.1)
    return folder


@pytest.fixture
def change(flight):
    """Changes what was measured on the flight; afterwards all is as it was."""
    before = {path: path.read_bytes() for path in flight.iterdir()}

    def changed(name, **values):
        path = flight / name
        path.write_text(json.dumps(json.loads(path.read_text()) | values))

    yield changed
    for path, content in before.items():
        path.write_bytes(content)


def bench_of(flight, **changes):
    """The same log as if a bench had left it."""
    run = BenchMeasurements(
        ticks=360, jitter=TimeHistogram([1e-3] * 360), latency=TimeHistogram([4e-3] * 360), bits=1000
    )
    run.samples.update({"coil": 360})
    grown = {"fsw": changes.pop("grown", 0.5)}
    numbers, lines = judge(run, Budgets(10.0, 50.0, 0, 50.0, 2.0), ("coil",), 1, grown)
    memory = {"every_s": 1.0, "warm": 2, "kib": {"fsw": [900, 990, 1000, 1000]}, "load_average": [0.5, 1.5]}
    numbers |= {"scenario": "microsat", "bus": "loop:1", "tick_hz": 1, "scheduling": "ordinary, nice 0"}
    numbers |= {
        "memory": memory,
        "ended": {},
        "second_senders": [],
        "budgets": [line._asdict() for line in lines],
    }
    (flight / "hil.json").write_text(json.dumps(numbers | changes))


def broken(part):
    return [line.name for line in part.lines if not line.kept]


@pytest.mark.long
def test_a_flight_keeps_all_and_says_how_fast_it_was(flight):
    part = soak.flight_part(flight, 50.0)
    assert broken(part) == []
    assert "0.1 simulated hours" in part.description
    assert {line.name for line in part.lines} >= {"ticks without an answer", "memory, growth [%]"}
    assert "replay of 360 ticks not bit-exact" in {line.name for line in part.lines}
    assert len(part.memory["kib"]["flight"]) == 6


def test_growth_late_steps_and_unanswered_ticks_are_found(flight, change):
    change("soak.json", steps={"longest_s": 0.2, "above": 1}, growth_percent={"flight": 2.5})
    change("run.json", flown={"ticks": 360, "slips": 3, "wall_s": 1.0})
    part = soak.flight_part(flight, 2.0)
    assert broken(part) == ["ticks without an answer", "steps above 100 ms", "memory, growth [%]"]


def test_a_refusal_a_cut_log_and_another_answer_are_found(flight, change):
    log = flight / "bus.log"
    log.write_bytes(log.read_bytes().replace(b" 180#", f" {CoilRefused.ID:03X}#".encode(), 1))
    found = broken(soak.flight_part(flight, 50.0))
    assert "requests that the coil board refused" in found
    assert "log cut or altered" in found
    assert found[-1].startswith("replay of ")


@pytest.mark.long
def test_the_page_tells_both_and_a_broken_budget_is_exit_code_1(
    flight, change, tmp_path, capsys, monkeypatch
):
    bench_of(flight)
    words = ["--flight", str(flight), "--hil", str(flight), "--out", str(tmp_path / "soak.md")]
    words += ["--memory-percent", "50"]
    assert soak.main(words) == 0
    page = (tmp_path / "soak.md").read_text()
    assert "BROKEN" not in page
    assert "| SYNC to TICK_DONE | 4.000 | 4.000 | 4.000 |" in page
    assert page in capsys.readouterr().out
    assert (tmp_path / "soak.svg").read_text().count("<svg") == 1
    bench_of(flight, grown=2.5)
    monkeypatch.setattr(soak, "draw", lambda parts, path: None)
    assert soak.main(words) == 1
    assert "| memory of fsw, growth [%] | 2.5 | 2 | BROKEN |" in (tmp_path / "soak.md").read_text()
    bench_of(flight, ended={"fsw": "killed"})
    assert broken(soak.bench_part(flight)) == ["nodes that ended before their time"]
    bench_of(flight, second_senders=["2 of TICK_DONE"])
    assert broken(soak.bench_part(flight)) == ["second senders on the bus"]
    bench_of(flight, budgets=[])
    assert broken(soak.bench_part(flight)) == ["memory that could not be read"]


def test_what_is_not_there_is_one_sentence(tmp_path, capsys):
    assert soak.main(["--flight", str(tmp_path / "none"), "--hil", str(tmp_path)]) == 2
    (sentence,) = capsys.readouterr().err.splitlines()
    assert "none" in sentence


def test_a_bench_of_an_earlier_soak_is_not_taken_for_that_of_this_one(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(soak, "bench", lambda *given: pytest.fail("nothing may run"))
    (tmp_path / "hil").mkdir()
    (tmp_path / "hil" / "hil.json").write_text("{}")
    words = ["--flight", str(tmp_path), "--keep", str(tmp_path), "--out", str(tmp_path / "soak.md")]
    assert soak.main(words) == 2
    assert f"{tmp_path / 'hil'} holds a bench already" in capsys.readouterr().err
    assert not (tmp_path / "soak.md").exists()


def test_more_hours_than_a_run_can_have_are_one_sentence(tmp_path, capsys):
    assert soak.main(["--hours", "1e12", "--out", str(tmp_path / "soak.md")]) == 2
    assert "--hours 1e+12: a run has at most" in capsys.readouterr().err


def test_the_bench_is_armed_at_10_hz_and_held_to_the_budget(monkeypatch, tmp_path):
    benches, words = [], []
    monkeypatch.setattr(soak.subprocess, "run", lambda command, **_: words.extend(command[3:]))
    monkeypatch.setattr(command, "hil", lambda bench: benches.append(bench) or 0)
    soak.bench(tmp_path / "hil", "microsat", 3600.0, None, ("--memory-percent", "1.5"))
    with pytest.raises(SystemExit):
        cli.main(words)
    (bench,) = benches
    assert (bench.scenario.time.tick_hz, bench.armed, bench.seconds) == (10, True, 3600.0)
    assert (bench.warm_s, bench.budgets.memory_percent, bench.out) == (60.0, 1.5, tmp_path / "hil")
