"""``torquer.campaign``: results as a table, statistics as values, runs flown again."""

import json
import sys

import pytest

import torquer
from sim.campaign.flight import digest_of

pytestmark = pytest.mark.long

FILE = """
scenario = "microsat"
runs = 4
orbits = 0.005
requirement.pointing_deg = 45.0

[[disperse]]
key = "initial.angle_deg"
distribution = "uniform"
low = 10.0
high = 70.0
"""


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "campaign.toml").write_text(FILE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sim.campaign.report.page.write_page", lambda path, *rest: path.write_text(""))
        return torquer.campaign(folder / "campaign.toml", workers=1, out=folder / "out")


@pytest.mark.slow
def test_results_have_a_row_a_run_with_what_was_drawn(done):
    table = done.results
    assert list(table.index) == [0, 1, 2, 3]
    assert table.index.name == "run"
    assert (table.status == "done").all()
    assert table.input_initial_angle_deg.between(10.0, 70.0).all()
    assert table.input_initial_angle_deg.nunique() == 4
    assert str(table.nees_mean.dtype) == "float64"
    assert done.failures == {}


def test_statistics_are_values_of_json(done):
    statistics = json.loads(json.dumps(done.statistics))
    met = int((done.results.pointing_deg_max_last_orbit <= 45.0).sum())
    assert statistics["runs"] == 4
    assert statistics["success"]["total"] == 4
    assert statistics["success"]["count"] == int(done.results.success.sum())
    (requirement,) = statistics["requirements"].values()
    assert requirement["met"] is False
    assert not done.ok, "a requirement is missed"
    assert requirement["low"] <= requirement["value"] <= requirement["high"]
    figure = statistics["figures"]["pointing_deg_max_last_orbit"]
    assert figure["mean"] == pytest.approx(done.results.pointing_deg_max_last_orbit.mean())
    assert set(figure["percentiles"]) == {"0.05", "0.5", "0.95"}
    assert 0 < met < 4
    assert "initial_angle_deg" in statistics["rank_correlations"]


def test_the_command_on_its_folder_prints_the_same(done, command):
    said = command("campaign", done.path)
    assert said.exit_code == 1
    assert said.stderr.startswith(
        "torquer: missed: pointing error, RMS over the last orbit, at most 45 deg: "
    )
    assert said.stdout.startswith(f"{done}\n")
    assert f"page: {done.page}" in said.stdout


def test_a_run_is_flown_again_bit_for_bit(done, tmp_path):
    run = done.fly(2, out=tmp_path / "run")
    assert run.summary["seed"] == done.results.seed[2]
    assert digest_of(run.log).frames == done.results.frames_sha256[2]
    with pytest.raises(torquer.InputError, match="--run 4"):
        done.fly(4)


def test_an_export_that_cannot_be_made_is_refused_before_anything_flies(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(torquer.InputError, match=r"--parquet needs pyarrow: .*torquer\[parquet\]"):
        torquer.campaign("microsat", runs=1, orbits=0.005, parquet=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"source": "nowhere"}, "nowhere"),
        ({"source": 3}, "source = 3"),
        ({"runs": 0}, "runs = 0"),
        ({"runs": "many"}, "runs = 'many'"),
        ({"orbits": -1.0}, "orbits = -1"),
        ({"workers": 0}, "workers = 0"),
        ({"keep": "some"}, "keep = 'some'"),
        ({"set": {"no.key": 1}}, "no"),
        ({"set": 3}, "dictionary"),
    ],
    ids=str,
)
def test_wrong_input_is_one_sentence_and_leaves_nothing(arguments, says, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(torquer.InputError, match=says):
        torquer.campaign(**{"source": "microsat", **arguments})
    assert list(tmp_path.iterdir()) == []
