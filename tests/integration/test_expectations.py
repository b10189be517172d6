"""A flight by its command: what is expected of it, the exit code, and the same from its run."""

import json

import pytest
from click.testing import CliRunner

from torquer.cli.main import main

pytestmark = pytest.mark.long


def torquer(*words):
    return CliRunner().invoke(main, [*map(str, words)])


@pytest.fixture(scope="module")
def missed(tmp_path_factory):
    """A flight that begins 40 deg off, of which 2 are expected over its only orbit."""
    path = tmp_path_factory.mktemp("runs") / "run"
    words = ("microsat", "--bus", "virtual", "--orbits", "1", "--out", path)
    return torquer("sil", *words, "--expect", "ape<2", "--expect", "duty<9"), path


@pytest.mark.slow
def test_a_flight_that_misses_what_is_expected_fails(missed):
    done, path = missed
    assert done.exit_code == 1
    assert "required   FAILED: APE of whole attitude" in done.output
    assert "required   met: duty" in done.output
    assert "required   not judged: settling" in done.output
    assert "torquer: the flight failed: a requirement is missed: APE of whole attitude" in done.output
    summary = json.loads((path / "summary.json").read_text())
    verdicts = [one["verdict"] for one in summary["requirements"]]
    assert verdicts == ["not judged", "not judged", "not judged", "failed", "met"]
    assert summary["failures"]["requirements"] in done.output
    assert "Requirement missed: APE" in (path / "report.html").read_text()


@pytest.mark.slow
def test_the_report_of_the_run_judges_it_again(missed):
    _, path = missed
    done = torquer("report", path)
    assert done.exit_code == 1
    assert "the flight failed: a requirement is missed" in done.output


def test_a_flight_that_is_not_judged_does_not_fail(tmp_path):
    words = ("--bus", "virtual", "--orbits", "0.01", "--out", tmp_path / "run")
    done = torquer("sil", "microsat", *words)
    assert done.exit_code == 0
    assert "not judged: APE of whole attitude: judged by orbit 5, flown were 0.01 orbits" in done.output


def test_a_wrong_expectation_flies_nothing(tmp_path):
    done = torquer("sil", "microsat", "--bus", "virtual", "--out", tmp_path / "run", "--expect", "ape>2")
    assert done.exit_code == 2
    assert done.output.startswith("torquer: --expect 'ape>2': write INDEX<VALUE")
    assert len(done.output.splitlines()) == 1
    assert not (tmp_path / "run").exists()
