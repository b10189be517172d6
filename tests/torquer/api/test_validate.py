"""``torquer.validate``: the outcomes of the command, for programs."""

import shutil

import pytest

import torquer
from sim.validate.reference.reference_table import DATA


@pytest.fixture
def data(tmp_path):
    """A folder with one of the reference files."""
    folder = tmp_path / "data"
    folder.mkdir()
    shutil.copy(DATA / "eclipse.csv", folder)
    return folder


def test_it_is_what_the_command_prints_and_writes(data, command, tmp_path):
    told = []
    done = torquer.validate(reference=data, workers=1, out=tmp_path / "a.md", tell=told.append)
    result = command("validate", "--reference", data, "--workers", 1, "--out", tmp_path / "b.md")
    lines = [text for text in result.stdout.splitlines() if text.startswith(("PASS", "FAIL", "absent"))]
    assert sorted(str(done).splitlines()[:-1]) == sorted(lines)
    assert {one.claim.id for one in told} == {one.claim.id for one in done.outcomes}
    assert len(told) == len(done.outcomes)
    assert (done.ok, done.failures, done.page) == (True, (), tmp_path / "a.md")
    assert done.page.is_file()


def test_the_table_has_a_row_a_claim(data):
    done = torquer.validate(reference=data, workers=1)
    row = done.table.loc["reference.eclipse.planar"]
    assert (row.verdict, row.low <= row.ours <= row.high) == ("PASS", True)
    assert len(done.table) == len(done.outcomes)
    assert done.page is None


def test_a_claim_that_fails_is_told_and_no_error(data):
    comments, _, table = (data / "eclipse.csv").read_text().rpartition("#")
    words, head, *rows = table.splitlines()
    values = rows[0].split(",")
    values[head.split(",").index("frac_planar")] = "0.123"
    rows[0] = ",".join(values)
    (data / "eclipse.csv").write_text("\n".join([f"{comments}#{words}", head, *rows, ""]))
    done = torquer.validate(reference=data, workers=1)
    assert not done.ok
    assert "eclipse.csv line" in done.failures[0]


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"only": "nothing"}, "nothing"),
        ({"satellites": 0}, "validate: satellites"),
        ({"reference": "nowhere", "flight_data": "nowhere"}, "give one of them"),
        ({"record": True, "satellites": 3}, "leave out --satellites"),
    ],
)
def test_a_wrong_argument_is_one_sentence(given, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.validate(**given)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
