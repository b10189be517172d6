"""The framework: verdicts, which studies run, the page, exit codes."""

import multiprocessing
import os
import signal
import time
from functools import partial

import pytest
from click.testing import CliRunner

from sim.campaign.claim import Claim, Outcome, Study, Verdict
from sim.campaign.runner import Finished, run
from sim.errors import HarnessError
from sim.validate import command
from sim.validate.page import line, render
from sim.validate.registry import all_studies, chosen, find_repository
from torquer.cli.main import main

CLAIM = Claim("a.b", "Least | most", "Somebody 2001", "deg", low=1.0, high=2.0)


@pytest.mark.parametrize(
    ("ours", "verdict"),
    [(1.0, "PASS"), (2.0, "PASS"), (0.999, "FAIL"), (2.001, "FAIL"), (float("nan"), "FAIL")],
)
def test_a_figure_passes_within_its_limits(ours, verdict):
    assert CLAIM.judge(ours).verdict.value == verdict


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        ({"high": 3.0}, "<= 3"),
        ({"low": 3.0}, ">= 3"),
        ({"low": 1.0, "high": 2.0}, "1 to 2"),
        ({"high": 0.0}, "0"),
    ],
)
def test_limits_for_people(limits, text):
    assert Claim("a", "b", "c", "d", **limits).limits == text


def study(study_id, values, flown=False, limit=10.0):
    claim = Claim(study_id, f"sum of {study_id}", "arithmetic", "1", high=limit)
    tasks = tuple(partial(float, value) for value in values)
    return Study(study_id, tasks, lambda results: [claim.judge(sum(results), f"of {results}")], flown)


class TestRunner:
    @pytest.mark.parametrize("workers", [1, 2])
    def test_results_are_in_order_however_they_came(self, workers):
        studies = [study("one", [1, 2, 3]), study("none", []), study("two", [20])]
        seen, told = [], []
        finished = run(studies, workers, seen.append, lambda done: told.append(done.study.id))
        assert [done.results for done in finished] == [(1.0, 2.0, 3.0), (), (20.0,)]
        assert [done.outcomes[0].verdict.value for done in finished] == ["PASS", "PASS", "FAIL"]
        assert seen == [1, 2, 3, 4]
        assert sorted(told) == ["none", "one", "two"]

    def test_what_a_task_refuses_ends_the_run(self):
        def refuse():
            raise HarnessError("no")

        with pytest.raises(HarnessError, match="no"):
            run([Study("x", (refuse,), lambda results: [])], 1, lambda done: None, lambda done: None)

    def test_one_that_fails_does_not_wait_for_the_others(self):
        tasks = (partial(time.sleep, 60.0), partial(int, "no number"))
        began = time.monotonic()
        with pytest.raises(ValueError, match="no number"):
            run([Study("x", tasks, lambda results: [])], 2, lambda done: None, lambda done: None)
        assert time.monotonic() - began < 30.0
        assert not multiprocessing.active_children()


class TestChoice:
    STUDIES = (study("reference.igrf14", []), study("reference.tle", []), study("posat1", [], flown=True))

    def ids(self, *only, quick=False):
        return [chosen.id for chosen in chosen(self.STUDIES, only, quick)]

    def test_all_by_default_and_first_words_by_only(self):
        assert self.ids() == ["reference.igrf14", "reference.tle", "posat1"]
        assert self.ids("reference") == ["reference.igrf14", "reference.tle"]
        assert self.ids("reference.tle", "posat1") == ["reference.tle", "posat1"]

    def test_quick_leaves_out_flights(self):
        assert self.ids(quick=True) == ["reference.igrf14", "reference.tle"]
        with pytest.raises(HarnessError, match="--quick"):
            self.ids("posat1", quick=True)

    @pytest.mark.parametrize("word", ["refer", "posat", "nothing", ""])
    def test_words_that_fit_nothing_are_refused(self, word):
        with pytest.raises(HarnessError, match=r"no such claims; there are reference\.igrf14, "):
            self.ids(word)

    def test_without_a_repository_reference_checks_are_absent(self):
        absent = [s for s in all_studies(None) if s.id.startswith("reference.")]
        assert absent
        assert all(not s.tasks and s.conclude([])[0].verdict is Verdict.ABSENT for s in absent)

    def test_ids_are_unique_and_begin_with_their_study(self, pytestconfig):
        studies = all_studies(pytestconfig.rootpath)
        assert len({s.id for s in studies}) == len(studies) > 10


def ended_from_outside():
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_worker_that_is_killed_is_one_sentence():
    others = multiprocessing.active_children()
    studies = [Study(f"s{number}", (ended_from_outside,), lambda results: []) for number in range(3)]
    with pytest.raises(HarnessError, match="a worker process was ended from outside: 0 of 3 ") as caught:
        run(studies, 2, lambda done: None, lambda done: None)
    assert caught.value.exit_code == 1
    assert multiprocessing.active_children() == others


def test_the_repository_is_found_from_within(tmp_path, pytestconfig):
    assert find_repository(pytestconfig.rootpath / "sim" / "plant") == pytestconfig.rootpath
    (tmp_path / "pyproject.toml").write_text('name = "another"\n')
    assert find_repository(tmp_path) is None


class TestPage:
    def outcomes(self):
        return (
            CLAIM.judge(1.5, "row 7"),
            Claim("a.c", "Too much", "Her", "1", high=1e-9).judge(2e-9, "row 8"),
            Outcome(Claim("a.d", "Not there", "Nobody", ""), Verdict.ABSENT),
        )

    def page(self):
        return render([Finished(study("a", []), self.outcomes(), (), 1.0)], 61.4)

    def test_a_row_a_claim(self):
        rows = [row for row in self.page().splitlines() if row.startswith("| ") and "`a." in row]
        assert rows == [
            r"| Least \| most (`a.b`) | Somebody 2001 | 1.5 deg | 1 to 2 deg | PASS |",
            "| Too much (`a.c`) | Her | 2e-09 at row 8 | <= 1e-09 | FAIL |",
            "| Not there (`a.d`) | Nobody |  |  | absent |",
        ]

    def test_what_stands_around_the_table(self):
        page = self.page()
        assert page.startswith("# Validation\n")
        assert "1 claims hold, 1 fail, 1 absent." in page
        assert "Wall time 61 s. Python 3." in page
        assert "| claim | source | ours | tolerance | verdict |" in page

    def test_the_terminal_names_the_worst_row(self):
        texts = [line(outcome) for outcome in self.outcomes()]
        assert texts[1] == "FAIL   a.c: Too much: 2e-09 (<= 1e-09)  [row 8]"
        assert texts[2] == "absent a.d"


class TestCommand:
    def call(self, *words):
        return CliRunner().invoke(main, ["validate", "--workers", "1", *map(str, words)])

    def test_reference_files_that_agree(self, folder):
        folder.copy("eclipse.csv", rows=4)
        folder.copy("earth_sun.csv", rows=4)
        page = folder.path / "deep" / "page.md"
        result = self.call("--reference", folder.path, "--out", page)
        assert result.exit_code == 0
        assert "17 claims hold, 0 fail, 5 absent" in result.stdout
        assert "| eclipse.csv | 4 | kind, " in page.read_text()
        assert page.read_text().count("| PASS |") == 17

    def test_one_that_does_not_is_exit_code_1(self, folder):
        folder.copy("eclipse.csv", rows=20)
        line_number = folder.add("eclipse.csv", 12, "frac_planar", 1e-5)
        result = self.call("--reference", folder.path)
        assert result.exit_code == 1
        failed = [text for text in result.stdout.splitlines() if text.startswith("FAIL")]
        assert len(failed) == 1
        assert f"eclipse.csv line {line_number} " in failed[0]

    def test_malformed_files_are_one_sentence_and_exit_code_2(self, folder):
        folder.copy("eclipse.csv", rows=4)
        line_number = folder.put("eclipse.csv", 2, "sun_x_km", lambda _: "far")
        result = self.call("--reference", folder.path)
        assert result.exit_code == 2
        expected = f"torquer: {folder.path / 'eclipse.csv'}, line {line_number}, column sun_x_km: 'far'"
        assert result.stderr == f"{expected} is no finite number\n"

    @pytest.mark.parametrize("words", [("--reference", "nowhere"), ("--only", "nothing"), ("--workers", "0")])
    def test_what_cannot_be_done_is_exit_code_2(self, words):
        result = self.call(*words)
        assert result.exit_code == 2
        assert result.stderr.startswith("torquer: ")
        assert result.stderr.count("\n") == 1

    def test_only_a_whole_validation_writes_the_page_by_itself(self, tmp_path, monkeypatch):
        parts = [study("a", [1.0]), study("b", [2.0], flown=True)]
        monkeypatch.setattr(command, "all_studies", lambda repository: parts)
        monkeypatch.setattr(command, "find_repository", lambda start: tmp_path)
        page = tmp_path / "docs" / "validation.md"
        for words in (["--quick"], ["--only", "a"]):
            assert self.call(*words).exit_code == 0
            assert not page.exists()
        result = self.call()
        assert result.exit_code == 0
        assert page.read_text().count("| PASS |") == 2
        assert f"page: {page}" in result.stdout
        monkeypatch.setattr(command, "find_repository", lambda start: None)
        monkeypatch.chdir(tmp_path)
        self.call()
        assert (tmp_path / "validation.md").exists()
