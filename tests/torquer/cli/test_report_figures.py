"""``torquer report --figures``: what it says and writes."""

import json
import shutil

import pytest
from click.testing import CliRunner

import torquer
from torquer.cli.main import main

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    return torquer.fly("microsat", orbits=0.02, out=tmp_path_factory.mktemp("runs") / "run").path


@pytest.fixture
def run(flown, tmp_path):
    return shutil.copytree(flown, tmp_path / "run")


def report(*words):
    return CliRunner().invoke(main, ["report", *map(str, words)])


@pytest.mark.slow
def test_it_says_which_figures_it_has_drawn(run):
    result = report(run, "--figures", "pdf")
    assert result.exit_code == 0
    said = next(line for line in result.stdout.splitlines() if line.startswith("figures: "))
    assert said.startswith(f"figures: {run / 'figures'}: pointing.pdf, rates.pdf, ")
    assert (run / "figures" / "pointing.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.slow
def test_the_document_names_them_where_they_are_asked_for(run):
    assert "figures" not in json.loads(report(run, "--json").stdout)
    assert not (run / "figures").exists()
    files = json.loads(report(run, "--figures", "svg", "--json").stdout)["figures"]
    assert files[0] == str(run / "figures" / "pointing.svg")


def test_another_format_is_refused(run):
    result = report(run, "--figures", "png")
    assert result.exit_code == 2
    assert "'png' is not one of 'pdf', 'svg'" in result.stderr
    assert not (run / "figures").exists()


def test_a_folder_that_cannot_be_written_is_one_sentence(run):
    (run / "figures").write_text("no folder")
    result = report(run, "--figures", "pdf")
    assert result.exit_code == 2
    assert f"{run / 'figures'}: cannot be written" in result.stderr
    assert len(result.stderr.splitlines()) == 1
