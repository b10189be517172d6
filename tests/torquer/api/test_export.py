"""``torquer.export``: the files of the command, for programs."""

import pandas as pd
import pytest

import torquer


def test_it_writes_what_the_command_writes(flown, command, tmp_path):
    ours, its = tmp_path / "a.csv", tmp_path / "b.csv"
    written = torquer.export(flown, ours)
    result = command("export", flown.path, "--out", its)
    assert ours.read_bytes() == its.read_bytes()
    assert result.stdout == str(written).replace("a.csv", "b.csv") + "\n"
    assert (written.ok, written.path) == (True, ours)
    assert len(pd.read_csv(written)) == flown.summary["ticks"]


def test_a_run_exports_itself_in_the_format_that_is_named(flown, tmp_path):
    written = flown.export(tmp_path / "bus", format="asc")
    assert written.path.read_text().startswith("date ")
    assert written._repr_html_() == f"<pre>{written}</pre>"


def test_a_changed_file_of_the_run_is_told(copy, tmp_path):
    with (copy.path / "scenario.toml").open("a") as file:
        file.write("\n")
    written = copy.export(tmp_path / "run.asc")
    assert not written.ok
    assert "scenario.toml" in written.notes[0]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"out": "run.xyz"}, "run.xyz: say by --format which it is"),
        ({"out": "run.csv", "format": "excel"}, "export: format"),
        ({"out": "there.csv"}, "there.csv already exists"),
        ({"out": "run.csv", "law": "idle.py:idle"}, "the run flew 'mpc', a law of the table"),
    ],
)
def test_a_wrong_argument_is_one_sentence_and_writes_nothing(flown, given, sentence, tmp_path):
    (tmp_path / "there.csv").write_text("mine")
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.export(flown.path, **given | {"out": tmp_path / given["out"]})
    assert "\n" not in str(caught.value)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("there.csv", "mine")]
