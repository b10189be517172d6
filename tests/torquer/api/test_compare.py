"""``torquer.compare``: what the command flies and writes, for programs."""

import json

import pytest

import torquer
from fsw.own_law import Demand

SHORT = {"laws": ["predictive", "rate_damping"], "driver": "pulsed", "orbits": 0.02, "workers": 1}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    return torquer.compare("posat1", **SHORT, out=tmp_path_factory.mktemp("compare") / "a")


@pytest.mark.long
def test_it_is_what_the_command_prints_and_writes(done, command, tmp_path):
    words = ("--laws", "predictive,rate_damping", "--driver", "pulsed", "--orbits", 0.02, "--workers", 1)
    result = command("compare", "posat1", *words, "--out", tmp_path / "b")
    assert result.stdout.startswith(f"{done}\nfiles: ")
    assert (done.path / "compare.json").read_bytes() == (tmp_path / "b" / "compare.json").read_bytes()
    assert json.loads((done.path / "compare.json").read_text()) == json.loads(json.dumps(done.values))
    assert (done.ok, done.failures) == (True, ())
    assert done.page.is_file()


@pytest.mark.long
def test_the_table_has_a_row_a_flight_best_first(done):
    assert list(done.table.law) == [row.law for row in done.rows]
    assert list(done.table.columns)[:3] == ["law", "aim", "driver"]
    assert done.table.rate_rms_degps.is_monotonic_increasing
    assert done._repr_html_() == f"<pre>{done}</pre>"


@pytest.mark.long
def test_a_scenario_as_an_object_is_flown_as_its_name_is(done, tmp_path):
    given = torquer.compare(torquer.scenarios()["posat1"], **SHORT, out=tmp_path / "c")
    assert given.rows == done.rows


@pytest.mark.long
def test_settings_are_laid_over_all_flights_and_told(tmp_path):
    changed = {"initial": {"rate_degps": [0.5, 0.0, 0.0]}, "control.k_w": 1.0}
    found = torquer.compare("posat1", **SHORT | {"laws": "predictive"}, set=changed, out=tmp_path / "a")
    assert found.values["settings"] == ["initial.rate_degps=[0.5, 0.0, 0.0]", "control.k_w=1.0"]


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.slow
def test_a_law_is_given_as_an_object_to_this_process_while_others_fly_the_rest(done, workers, tmp_path):
    def idle(inputs, memory, setpoint, config):
        return Demand()

    found = torquer.compare("posat1", **SHORT | {"workers": workers}, law=idle, out=tmp_path / "a")
    assert found.ok, "all of them have flown"
    assert sorted(row.law for row in found.rows) == ["idle", "predictive", "rate_damping"]
    assert [row for row in found.rows if row.law != "idle"] == list(done.rows)


def test_what_is_no_law_is_refused(tmp_path):
    with pytest.raises(torquer.InputError, match=r"law = 3: give FILE\.py:NAME"):
        torquer.compare("posat1", law=3, out=tmp_path / "a")


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"laws": "predictiv"}, "--laws predictiv: there is no law 'predictiv'"),
        ({"laws": [1]}, "compare: laws = \\[1\\]: give names"),
        ({"driver": "sparse"}, "compare: driver"),
        ({"orbits": 0.0}, "compare: orbits"),
        ({"gains": "none.json"}, "--gains none.json: there is no such file"),
        ({"set": 3}, "give a dictionary"),
        ({"set": {"control.k_x": 1}}, "control.k_x"),
    ],
)
def test_a_wrong_argument_is_one_sentence_and_writes_nothing(given, sentence, tmp_path):
    with pytest.raises(torquer.InputError, match=sentence) as caught:
        torquer.compare("posat1", **given, out=tmp_path / "a")
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())
