"""Gains in a file: read back as they were, refused for another body, continued where a search stopped."""

import pytest

from fsw.core.laws.table import LAWS
from fsw.input.schema import merge
from sim.errors import HarnessError
from sim.scenario.schema import load, shipped_names
from sim.tuning import command, kept
from sim.tuning.applicable import coils_of, is_suited, laws_for
from sim.tuning.cost import Cost, cost_of
from sim.tuning.kept import (
    KeptGains,
    body_checksum,
    gains_text,
    read_gains,
    shipped_gains,
    write_gains,
)
from sim.tuning.search import WORSE, TunedGains, fly_whole

FOUND = TunedGains(
    "lqr",
    "pulsed",
    {"k_w": 1e6, "gains": {"lqr": {"effort": 0.2}}},
    Cost(0.5, 1.25, 0.3),
    Cost(0.9, None, 2.0),
    24,
)


@pytest.fixture
def gains():
    return KeptGains(7, 24, 4.0).with_row(FOUND)


def test_a_file_is_read_back(gains, tmp_path):
    write_gains(tmp_path / "deep" / "a.toml", gains)
    assert read_gains(tmp_path / "deep" / "a.toml") == gains
    assert gains.control("pulsed", "lqr") == FOUND.control
    assert gains.control("continuous", "lqr") is None
    assert read_gains(tmp_path / "none.toml") is None


RULES = "[found]\nbody = 1\nflights = 24\norbits = 4.0\nseed = 2\n"


@pytest.mark.parametrize(
    "text",
    [
        "a = ",
        "a = 1",
        "[found]\nbody = 1\n",
        "\xff",
        f"pulsed = 3\n{RULES}",
        f"{RULES}[pulsed.pd]\ncost = 1.0\ncost_before = 1.0\nrms = 1.0\n",
        f"{RULES}[pulsed.pd]\ncost_before = 1.0\nrms = 1.0\n[pulsed.pd.control]\nk_w = 1.0\n",
    ],
)
def test_another_file_is_refused_by_its_name(tmp_path, text):
    path = tmp_path / "a.toml"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(HarnessError, match=r"a\.toml: (no gains of|gains cannot be read)"):
        read_gains(path)


@pytest.mark.parametrize(
    "over",
    [
        {"body": {"inertia_kgm2": [1.0, 1.85, 1.95]}},
        {"initial": {"angle_deg": 41.0}},
        {"coils": {"backoff_s": 50.0}},
        {"disturbance": {"torque_nm": [0.0, 0.0, 0.0]}},
        {"disturbance": {"residual_dipole_am2": [0.0, 0.0, 0.01]}},
        {"control": {"spin_radps": 0.01}},
        {"control": {"leak_s": 100.0}},
        {"coils": {"max_dipole_am2": 0.05}},
        {"coils": {"on_fraction": 0.5}},
        {"time": {"tick_hz": 2}},
        {"flight": {"modes": {"axis_only": True}}},
    ],
)
def test_gains_are_for_one_body_start_coils_torque_and_rules(over):
    assert body_checksum(load("microsat", over)) != body_checksum(load("microsat"))


def test_driver_law_and_gains_are_not_the_body():
    other = {"control": {"law": "pd", "k_w": 1.0}, "coils": {"driver": "continuous", "max_dipole_am2": 8.0}}
    assert body_checksum(load("microsat", other)) == body_checksum(load("microsat"))


@pytest.mark.long
def test_those_that_ship_are_for_the_scenario_as_it_is():
    for path in kept.FOLDER.glob("*.toml"):
        assert path.stem in shipped_names()
        scenario = load(path.stem)
        assert shipped_gains(scenario) == read_gains(path)
        assert shipped_gains(load(path.stem, {"initial": {"angle_deg": 12.0}})) is None


def test_those_that_ship_are_of_every_law_that_suits_the_body_and_of_no_other():
    for path in kept.FOLDER.glob("*.toml"):
        scenario = load(path.stem)
        for driver in command.DRIVERS:
            suited = {law for law in laws_for(scenario) if is_suited(law, scenario, driver)}
            assert set(read_gains(path).rows[driver]) == suited, (path.stem, driver)


def test_those_that_ship_are_no_worse_in_a_whole_flight_than_the_scenarios_own():
    for path in kept.FOLDER.glob("*.toml"):
        for rows in read_gains(path).rows.values():
            for law, row in rows.items():
                better = row["cost"] < row["cost_before"]
                assert better or (not row["control"] and row["cost"] == row["cost_before"]), (path.stem, law)


@pytest.mark.long
@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.stem for path in kept.FOLDER.glob("*.toml")))
def test_those_that_ship_still_fly_as_they_did(name):
    """One law of each aim and driver of a body; ``make gains`` flies all of them."""
    scenario, shipped = load(name), read_gains(kept.FOLDER / f"{name}.toml")
    for driver, rows in shipped.rows.items():
        by_aim = {LAWS[law].aim: law for law, row in rows.items() if row["control"]}
        for law in by_aim.values():
            row, over = rows[law], merge(coils_of(scenario, driver), {"control": {"law": law}})
            flown = load(name, merge(over, {"control": rows[law]["control"]}))
            today = cost_of(fly_whole(flown, shipped.seed, shipped.orbits), flown, LAWS[law].aim)
            assert today.total <= row["cost"] * (1.0 + WORSE), (law, driver)


def test_the_gains_in_a_line():
    assert gains_text(FOUND.control) == "k_w 1e+06, gains.lqr.effort 0.2"
    assert gains_text({}) == "the scenario's"


class TestCommand:
    @pytest.fixture
    def searched(self, monkeypatch):
        laws = []

        def tune(name, over, law, *_):
            laws.append((law, over["coils"]["driver"]))
            driver = over["coils"]["driver"]
            return TunedGains(law, driver, {"k_w": 1.0}, Cost(0.5, 1.0, 0.3), Cost(0.9, None, 2.0), 4)

        monkeypatch.setattr(command, "tune", tune)
        return laws

    @pytest.fixture
    def confirmed(self, monkeypatch):
        """The laws whose gains were flown again, with these and what they had cost; a little worse today."""
        laws = []

        def confirm(name, over, law, control, total, *_):
            laws.append((law, control, total))
            driver = over["coils"]["driver"]
            return TunedGains(law, driver, control, Cost(0.52, 1.0, 0.3), Cost(0.9, None, 2.0), 0)

        monkeypatch.setattr(command, "confirm", confirm)
        return laws

    def test_each_law_by_each_driver_that_it_has_a_use_for(self, searched, tmp_path, capsys):
        path = tmp_path / "a.toml"
        found = command.design_laws("microsat", {}, "pd,pulse_mpc", path, workers=1)
        assert searched == [("pd", "pulsed"), ("pulse_mpc", "pulsed"), ("pd", "continuous")]
        assert read_gains(path) == found
        assert "pd, pulsed: settled after 1.00 orbits, then 0.3 RMS" in capsys.readouterr().out

    def test_what_the_file_has_is_borne_out_and_not_searched_again(
        self, searched, confirmed, tmp_path, capsys
    ):
        path = tmp_path / "a.toml"
        command.design_laws("microsat", {}, "pd", path, workers=1)
        row, before = read_gains(path).rows["pulsed"]["pd"], path.read_bytes()
        searched.clear()
        command.design_laws("microsat", {}, "pd,lqr", path, workers=1)
        assert {law for law, _ in searched} == {"lqr"}
        assert confirmed == [("pd", row["control"], row["cost"])] * 2
        assert read_gains(path).rows["pulsed"]["pd"] == row
        assert path.read_bytes() != before
        assert "pd, pulsed: settled after 1.00 orbits, then 0.3 RMS; cost 0.520" in capsys.readouterr().out

    def test_what_no_longer_flies_so_is_replaced_and_said(self, searched, monkeypatch, tmp_path, capsys):
        path = tmp_path / "a.toml"
        command.design_laws("microsat", {}, "pulse_mpc", path, workers=1)
        capsys.readouterr()

        def confirm(name, over, law, control, total, *_):
            return TunedGains(law, "pulsed", {"k_w": 2.0}, Cost(0.4, 1.0, 0.2), Cost(0.9, None, 2.0), 24)

        monkeypatch.setattr(command, "confirm", confirm)
        command.design_laws("microsat", {}, "pulse_mpc", path, workers=1)
        assert read_gains(path).control("pulsed", "pulse_mpc") == {"k_w": 2.0}
        assert "searched again, as the file's cost 0.500 no longer" in capsys.readouterr().out

    @pytest.mark.long
    @pytest.mark.slow
    def test_two_processes_find_what_one_finds(self, tmp_path):
        one, two = (
            command.design_laws("microsat", {}, "pd,lqr", tmp_path / f"{workers}.toml", 5, 0.3, workers)
            for workers in (1, 2)
        )
        assert one == two
        assert (tmp_path / "1.toml").read_bytes() == (tmp_path / "2.toml").read_bytes()

    @pytest.mark.parametrize(
        ("over", "flights"),
        [({"initial": {"angle_deg": 10.0}}, None), ({}, 5), ({"body": {"inertia_kgm2": [1, 2, 2.5]}}, None)],
        ids=["start", "flights", "body"],
    )
    def test_a_file_of_something_else_is_left_alone(self, searched, tmp_path, over, flights):
        path = tmp_path / "a.toml"
        command.design_laws("microsat", {}, "pd", path, workers=1)
        before = path.read_bytes()
        searched.clear()
        with pytest.raises(
            HarnessError, match=r"a\.toml: holds gains of another body, .* give --keep another"
        ):
            command.design_laws("microsat", over, "pd", path, flights, workers=1)
        assert (path.read_bytes(), searched) == (before, [])

    @pytest.mark.parametrize(
        ("text", "says"), [("law = 3\n", "'found' is missing"), (None, "Is a directory")]
    )
    def test_what_is_no_file_of_gains_is_named_and_left_alone(self, searched, tmp_path, text, says):
        path = tmp_path / "a.toml"
        path.mkdir() if text is None else path.write_text(text)
        with pytest.raises(HarnessError, match=says) as told:
            command.design_laws("microsat", {}, "pd", path, workers=1)
        assert "Errno" not in str(told.value)
        assert path.is_dir() if text is None else path.read_text() == text
        assert searched == []

    def test_the_wheel_counts(self):
        slower = {"wheel": {"max_torque_nm": 0.0005}}
        assert body_checksum(load("microsat-wheel")) != body_checksum(load("microsat-wheel", slower))

    def test_an_unknown_law_is_named(self, tmp_path):
        with pytest.raises(HarnessError, match="--laws pdd: there is no law 'pdd'"):
            command.design_laws("microsat", {}, "pdd", tmp_path / "a.toml")

    def test_a_body_that_spins_has_shorter_steps(self):
        assert command.step_s(load("microsat")) == 10.0
        assert command.step_s(load("spinner")) == 8.0
        assert command.step_s(load("spinner", {"control": {"spin_radps": 0.1}})) == 4.0
