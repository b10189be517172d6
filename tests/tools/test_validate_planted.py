"""Planted errors of ``make validate-planted``: each is one place of the source, and is noticed by a claim."""

from pathlib import Path

import pytest
import validate_planted
from mutation_tests import ROOT
from validate_planted import PLANTS, TOO_LONG, Plant, Verdict, found, judge, main, misplaced, row, run_all

from sim.validate.registry import all_studies, choose_studies


def test_each_stands_once_in_the_source():
    assert not misplaced(ROOT, list(PLANTS))
    assert misplaced(ROOT, [PLANTS[0]._replace(old="not there")])


def test_there_are_ten_and_more_in_as_many_modules():
    assert len(PLANTS) >= 10
    assert len({plant.path for plant in PLANTS}) >= 10
    assert len({plant.name for plant in PLANTS}) == len(PLANTS)


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.name)
def test_its_claims_are_there(plant):
    assert plant.old != plant.new
    assert choose_studies(all_studies(1), [plant.only], quick=False)


@pytest.mark.parametrize(
    ("code", "failed", "noticed"),
    [(1, ["a.b"], True), (0, [], False), (1, [], False), (2, [], False), (2, ["a.b"], False)],
)
def test_only_a_claim_that_fails_notices(code, failed, noticed):
    verdict = Verdict(code, failed, 1.0)
    assert found(verdict) is noticed
    assert ("SURVIVES" in row(PLANTS[0], verdict)) is not noticed


def test_the_plant_is_there_while_it_is_judged_and_gone_afterwards(tmp_path, monkeypatch):
    (tmp_path / "law.py").write_text("torque = +1\n")
    seen = []

    def validate(folder: Path, only, timeout_s):
        seen.append(((folder / "law.py").read_text(), only))
        return Verdict(1, ["a.b"], 0.1)

    monkeypatch.setattr(validate_planted, "validate", validate)
    judge(tmp_path, Plant("sign", "law.py", "+1", "-1", "a"), 1.0)
    assert seen == [("torque = -1\n", ["a"])]
    assert (tmp_path / "law.py").read_text() == "torque = +1\n"


@pytest.mark.parametrize(
    ("sound", "planted", "code"),
    [
        (Verdict(0, [], 1.0), Verdict(1, ["a.b"], 1.0), 0),
        (Verdict(0, [], 1.0), Verdict(0, [], 1.0), 1),
        (Verdict(1, ["a.b"], 1.0), Verdict(1, ["a.b"], 1.0), 1),
    ],
)
def test_exit_code_1_if_one_survives_or_the_claims_fail_anyway(monkeypatch, capsys, sound, planted, code):
    monkeypatch.setattr(validate_planted, "copy_repository", lambda folder, names: None)
    monkeypatch.setattr(validate_planted, "misplaced", lambda folder, plants: [])
    monkeypatch.setattr(validate_planted, "validate", lambda folder, only, timeout_s: sound)
    monkeypatch.setattr(validate_planted, "judge", lambda folder, plant, timeout_s: planted)
    assert run_all(list(PLANTS[:2]), 1.0) == code
    assert ("2 of 2 are noticed" in capsys.readouterr().out) is (code == 0)


@pytest.mark.parametrize("failing", ["sound", "planted"])
def test_a_run_that_breaks_off_says_why(monkeypatch, capsys, failing):
    broken, verdicts = Verdict(2, [], 1.0, "no module of that name"), {"sound": Verdict(0, [], 1.0)}
    verdicts["planted"] = Verdict(1, ["a.b"], 1.0)
    verdicts[failing] = broken
    monkeypatch.setattr(validate_planted, "copy_repository", lambda folder, names: None)
    monkeypatch.setattr(validate_planted, "misplaced", lambda folder, plants: [])
    monkeypatch.setattr(validate_planted, "validate", lambda folder, only, timeout_s: verdicts["sound"])
    monkeypatch.setattr(validate_planted, "judge", lambda folder, plant, timeout_s: verdicts["planted"])
    assert run_all(list(PLANTS[:1]), 1.0) == 1
    assert " 2: no module of that name\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("program", "code", "failed", "error"),
    [
        ("sys.exit('no such claim')", 1, [], "no such claim"),
        ("print('FAIL a.b: 2'); sys.exit('page: a.md')", 1, ["a.b"], ""),
        ("print('page: a.md', file=sys.stderr)", 0, [], ""),
    ],
)
def test_what_was_said_is_told_of_a_run_that_broke_off(tmp_path, program, code, failed, error):
    verdict = validate_planted.validate(package_with(tmp_path, program), ["a"], 60.0)
    assert (verdict.code, verdict.failed, verdict.error) == (code, failed, error)


@pytest.mark.long
def test_a_run_that_hangs_notices_nothing(tmp_path):
    hung = validate_planted.validate(package_with(tmp_path, "time.sleep(60)"), ["a"], 0.2)
    assert hung == Verdict(TOO_LONG, [], 0.2, "not done after 0.2 s")
    assert not found(hung)


def package_with(folder: Path, program: str) -> Path:
    """A folder with a package torquer that runs the program."""
    package = folder / "torquer"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(f"import sys, time\n{program}\n")
    return folder


def test_a_name_of_no_plant_is_refused_beside_one_that_is(monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["validate_planted.py", PLANTS[0].name, "nothing like it"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert "there is no plant with 'nothing like it' in its name" in capsys.readouterr().err
