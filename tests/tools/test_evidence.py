"""``make evidence``: which stages run, what they end with, and what is said of the pages."""

from pathlib import Path

import evidence
import pytest
from evidence import STAGES, changes, main, rows_of, verdict

PAGE = """# Validation

| claim | ours | verdict |
|---|---|---|
| Pointing (`a`) | 1.2 deg | PASS |
| Time (`b`) | 3 s | PASS |
| Gone (`c`) | 3 s | PASS |
"""


@pytest.fixture
def docs(tmp_path, monkeypatch):
    monkeypatch.setattr(evidence, "DOCS", tmp_path)
    (tmp_path / "validation.md").write_text(PAGE)
    return tmp_path


@pytest.fixture
def run(docs, monkeypatch):
    """Stands for the stages: their exit codes by name, else 0; gives the names of those that ran."""
    names, codes = [], {}

    def stand_in(stage):
        names.append(stage)
        (docs / "validation.md").write_text(PAGE.replace("| 3 s | PASS", "| 9 s | FAIL", 1))
        return codes.get(stage, 0)

    monkeypatch.setattr(evidence, "run", stand_in)
    return names, codes


def test_all_stages_run_in_their_order(run, capsys):
    assert main([]) == 0
    assert run[0] == list(STAGES)
    assert capsys.readouterr().err.count("exit code 0") == len(STAGES)


def test_chosen_stages_run_in_the_order_of_all(run):
    assert main(["faults", "gains"]) == 0
    assert run[0] == ["gains", "faults"]


def test_another_stage_is_refused(run, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["gain"])
    assert (ended.value.code, run[0]) == (2, [])
    assert "there is no stage 'gain': choose among gains, population, " in capsys.readouterr().err


def test_a_claim_that_fails_is_exit_code_1_and_the_rest_is_computed(run):
    run[1]["population"] = 1
    assert main([]) == 1
    assert run[0] == list(STAGES)


@pytest.mark.parametrize("code", [2, 130, -9])
def test_a_stage_that_is_not_completed_ends_all(run, capsys, code):
    run[1]["validate"] = code
    assert main([]) == code
    assert run[0] == ["gains", "population", "validate"]
    assert capsys.readouterr().err.endswith("evidence: validate was not completed\n")


def test_an_interrupt_ends_all_with_its_exit_code(docs, monkeypatch, capsys):
    def stopped(stage):
        raise KeyboardInterrupt

    monkeypatch.setattr(evidence, "run", stopped)
    assert main([]) == 130
    assert capsys.readouterr().err.endswith("evidence: gains was not completed\n")


def test_another_verdict_is_named_and_other_rows_are_counted(run, capsys):
    main(["sizing"])
    out = capsys.readouterr().out
    assert out.endswith("validation.md: 1 rows changed\n  Time (`b`): PASS -> FAIL\n")


def test_rows_that_come_and_go_are_counted(docs):
    before = rows_of(docs)
    now = before | {("validation.md", "New (`d`)"): "1 | PASS |"}
    del now["validation.md", "Gone (`c`)"]
    assert list(changes(before, now)) == ["validation.md: 2 rows changed"]
    assert list(changes(before, before)) == []


@pytest.mark.parametrize(
    ("row", "word"),
    [("1.2 deg | PASS |", "PASS"), ("3 | not yet |", "not yet"), ("1 | 2.5 |", ""), ("", "")],
)
def test_a_verdict_is_a_last_cell_of_words(row, word):
    assert verdict(row) == word


def test_gains_are_replaced_when_all_of_a_body_are_searched(tmp_path, monkeypatch):
    """The search begins with those of the file, unless they are of another body: ``b`` has changed."""
    for name in ("a", "b", "c"):
        (tmp_path / f"{name}.toml").write_text("old")
    monkeypatch.setattr(evidence, "GAINS", tmp_path)
    monkeypatch.setattr(evidence, "load", str)
    monkeypatch.setattr(evidence, "shipped_gains", lambda scenario: None if scenario == "b" else scenario)

    def search(*words):
        name, file = words[3], Path(words[-1])
        before = file.read_text() if file.exists() else "nothing"
        file.write_text(f"found for {name} from {before}")
        return 130 if name == "c" else 0

    monkeypatch.setattr(evidence, "call", search)
    assert evidence.search_gains() == 130
    kept = [(tmp_path / f"{name}.toml").read_text() for name in ("a", "b", "c")]
    assert kept == ["found for a from old", "found for b from nothing", "old"]
