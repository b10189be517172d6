"""``torquer compare`` as a user meets it."""

import json
from dataclasses import replace

import pytest
from click.testing import CliRunner

from sim.compare import command, score
from sim.errors import HarnessError
from torquer.cli.main import main

SHORT = ("--laws", "predictive,rate_damping", "--orbits", "0.05", "--workers", "1")


@pytest.fixture
def torquer(tmp_path, monkeypatch):
    """Runs it in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, ["compare", *map(str, words)])


@pytest.mark.long
def test_two_laws_with_perfect_knowledge(torquer, tmp_path):
    result = torquer("posat1", *SHORT, "--out", tmp_path / "a")
    assert result.exit_code == 0, result.output
    read = json.loads((tmp_path / "a" / "compare.json").read_text())
    assert (read["scenario"], read["seed"], read["ticks"], read["judged"]["what"]) == (
        "posat1",
        1,
        303,
        "axis",
    )
    assert read["complete"] is True
    rows = {(row["law"], row["driver"]): row for row in read["rows"]}
    assert set(rows) == {
        (law, driver) for law in ("predictive", "rate_damping") for driver in ("pulsed", "continuous")
    }
    assert all(row["aim"] == "rate" and row["limits_ok"] and not row["failure"] for row in rows.values())
    assert all(50.0 < row["error_rms"] < 60.0 for row in rows.values())
    assert rows["predictive", "pulsed"]["pulses"] == 2
    assert rows["predictive", "pulsed"]["dipole_squared_a2m4s"] > 1000.0
    rates = [row["rate_rms_degps"] for row in read["rows"]]
    assert rates == sorted(rates)
    assert result.stdout.count("pulsed") == 2
    assert (tmp_path / "a" / "compare.csv").read_text().count("\n") == 5
    assert (tmp_path / "a" / "compare.png").stat().st_size > 10000


@pytest.mark.long
def test_the_same_again_is_the_same_to_the_byte(torquer, tmp_path):
    one_law = ("microsat", "--laws", "pd", "--driver", "continuous", "--orbits", "0.04", "--workers", "1")
    for folder, seed in (("a", 4), ("b", 4), ("c", 5)):
        assert torquer(*one_law, "--seed", seed, "--out", folder).exit_code == 0
    a, b, c = ((tmp_path / folder / "compare.csv").read_bytes() for folder in "abc")
    assert a == b
    assert a != c
    assert (tmp_path / "a" / "compare.json").read_bytes() == (tmp_path / "b" / "compare.json").read_bytes()


@pytest.mark.long
def test_a_flight_that_breaks_the_limits_is_no_result(torquer, monkeypatch):
    judge = score.judge
    monkeypatch.setattr(score, "judge", lambda *given: replace(judge(*given), limits_ok=False))
    result = torquer(
        "posat1", "--laws", "predictive", "--driver", "pulsed", "--orbits", "0.01", "--workers", "1"
    )
    assert result.exit_code == 1
    assert result.stderr.splitlines()[-1] == "torquer: the limits are broken by predictive (pulsed)"


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (("posat1", "--laws", "predictiv"), "there is no law 'predictiv'"),
        (("posat9",), "there is no scenario 'posat9'"),
        (("posat1", "--set", "control.k_x=1"), "control.k_x"),
        (("posat1", "--driver", "sparse"), "sparse"),
        (("microsat", "--set", "coils.time_constant_s=0.2"), "coils.on_fraction"),
    ],
)
def test_what_a_user_can_mend_is_one_sentence(torquer, tmp_path, words, named):
    result = torquer(*words)
    assert result.exit_code == 2
    assert named in result.stderr
    assert result.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("file", "what"), [("compare.json", "a comparison"), ("run.json", "a run")])
def test_what_a_folder_holds_is_not_mixed_with_a_comparison(torquer, tmp_path, file, what):
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / file).write_text("{}")
    result = torquer("posat1", *SHORT, "--out", "old")
    assert result.exit_code == 2
    assert f"already holds {what}" in result.stderr
    assert [path.name for path in (tmp_path / "old").iterdir()] == [file]


@pytest.mark.long
@pytest.mark.parametrize(
    ("lost", "words"),
    [({"predictive"}, SHORT), ({"predictive", "rate_damping"}, ("--laws", "rate", *SHORT[2:]))],
    ids=["one that was named", "all"],
)
def test_laws_that_could_not_be_flown_are_told_by_the_exit_code(torquer, monkeypatch, lost, words):
    fly, lost = score.record_order, lost if "predictive,rate_damping" in words else None

    def record_order(order):
        if lost is None or order.overrides["control"]["law"] in lost:
            raise HarnessError("no room")
        return fly(order)

    monkeypatch.setattr(score, "record_order", record_order)
    result = torquer("posat1", *words, "--driver", "pulsed")
    assert result.exit_code == 1
    assert "predictive (pulsed) was not flown: no room" in result.stderr
    assert ("compare.png" in result.stdout) is (lost is not None), "no flight, no picture"


@pytest.mark.long
def test_finished_flights_are_written_when_the_rest_is_given_up(torquer, tmp_path, monkeypatch):
    fly = command.fly_case

    def interrupted(case, by):
        if case.law == "rate_damping":
            raise KeyboardInterrupt
        return fly(case, by)

    monkeypatch.setattr(command, "fly_case", interrupted)
    result = torquer("posat1", "--laws", "predictive,pd,rate_damping", *SHORT[2:], "--out", "a")
    assert result.exit_code == 130
    read = json.loads((tmp_path / "a" / "compare.json").read_text())
    assert read["complete"] is False
    assert [row["law"] for row in read["rows"]] == ["pd"]
