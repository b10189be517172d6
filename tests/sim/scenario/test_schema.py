"""Scenarios: those that ship are sound, settings are laid over them, and errors are one sentence."""

import re
from datetime import UTC, datetime
from importlib import resources
from math import hypot, nan
from pathlib import Path

import pytest

from fsw.input.schema import TableError, section_in
from fsw.table.cells import QUANTUM
from fsw.table.config import flight_config
from fsw.table.estimator import table_bounds
from fsw.table.table import FlightTable
from fsw.wire.messages import MagField, SunVector
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario, flight_table, load, orbit_period_s, parse_settings, shipped
from sim.scenario.sections import BUS_STEP_NT, BUS_STEP_PERCENT, BUS_STEP_SUN
from sim.sizing.deviations import deviations

NAMES = [scenario.name for scenario in shipped()]
TLE = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)


def settings(*texts):
    return parse_settings(texts)


def keys_of(model, path=()):
    """Each key of a section and of those within it, as a path."""
    for name, field in model.model_fields.items():
        yield (*path, name)
        section = section_in(field.annotation)
        if section is not None:
            yield from keys_of(section, (*path, name))


def fault(name="microsat", **overrides):
    with pytest.raises(TableError) as caught:
        load(name, overrides)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


class TestFlightTable:
    def test_that_of_the_latest_scenario_is_kept(self):
        scenario = load("microsat")
        assert flight_table(scenario) is flight_table(scenario)

    def test_each_scenario_has_its_own(self):
        one, other = load("microsat"), load("microsat", {"time": {"tick_hz": 5}})
        for scenario in (one, other, one, other):
            assert flight_table(scenario).time.tick_hz == scenario.time.tick_hz
        same = load("microsat")
        assert flight_table(same) == flight_table(one)

    def test_a_changed_copy_has_that_of_its_own_values(self):
        scenario = load("microsat")
        flight_table(scenario)
        changed = scenario.model_copy(update={"flight": {"telemetry": {"attitude_s": 7.0}}})
        assert flight_table(changed) != flight_table(scenario)


class TestShipped:
    def test_the_three_are_there(self):
        assert {"microsat", "cubesat3u", "posat1"} <= set(NAMES)

    @pytest.mark.parametrize("name", NAMES)
    def test_can_be_flown(self, name):
        scenario = load(name)
        assert scenario.name == name
        assert scenario.summary
        config = flight_config(flight_table(scenario))
        plant = Plant(plant_config(scenario, seed=1))
        assert plant.begin_tick()
        assert config.epoch_unix_s == scenario.epoch_unix_s

    @pytest.mark.parametrize("name", NAMES)
    def test_is_written_with_comments_and_units(self, name):
        text = resources.files("sim.scenario.shipped").joinpath(f"{name}.toml").read_text(encoding="utf-8")
        assert text.startswith("# ")
        for unit in ("kg", "A m^2", "deg", "N m"):
            assert unit in text

    @pytest.mark.parametrize("name", [name for name in NAMES if load(name).knowledge == "filter"])
    def test_a_satellite_that_is_as_its_table_says_declares_so(self, name):
        """But for bias and torque: with ordinary bounds the filter is less certain than it need be."""
        scenario = load(name)
        found = [
            one
            for one in deviations(scenario, table_bounds(flight_table(scenario)))
            if one.of_table not in {"torque_nm", "magnetometer_bias_nt"}
        ]
        assert any(one.worst > 0.0 for one in found) or not any(one.bound > 0.0 for one in found)

    @pytest.mark.parametrize("name", ["microsat", "cubesat3u"])
    def test_the_lowest_level_is_small_enough_to_point_by_pulses(self, name):
        """3 s m_low B / J_min of about w0 / 20 or less, at 45 uT."""
        scenario = load(name)
        least = min(scenario.body.inertia[axis][axis] for axis in range(3))
        kick_radps = scenario.coils.pulse_s * scenario.coils.levels_am2[0] * 45e-6 / least
        assert kick_radps <= 2.0 * 3.14159 / orbit_period_s(scenario) / 15.0

    def test_microsat_is_as_the_contract_says(self):
        scenario = load("microsat")
        assert scenario.body.inertia_kgm2 == (1.02, 1.85, 1.95)
        assert scenario.orbit.tle == TLE
        assert scenario.coils.levels_am2 == (0.5, 2.0, 8.0)
        assert (scenario.coils.backoff, scenario.coils.pulse_s, scenario.coils.backoff_s) == (
            "shared",
            3.0,
            100.0,
        )
        assert scenario.disturbance.torque_nm == (3e-8, 3e-8, 3e-8)
        assert scenario.sensors.magnetometer.noise_nt == 200.0
        assert scenario.sensors.sun.noise_deg == 0.5
        assert (scenario.initial.axis, scenario.initial.angle_deg) == ((1.0, 1.0, 1.0), 40.0)
        assert scenario.initial.rate_degps == (0.05, 0.05, 0.05)
        assert (scenario.time.tick_hz, scenario.knowledge) == (1, "filter")


class TestFinding:
    def test_an_unknown_name_is_refused_with_a_list_of_names(self):
        sentence = fault("macrosat")
        assert "there is no scenario 'macrosat'" in sentence
        assert f"choose one of {', '.join(sorted(NAMES))}, or" in sentence
        assert {"cubesat3u", "microsat", "posat1"} <= set(NAMES)

    def test_a_file_by_its_path(self, tmp_path):
        file = tmp_path / "mine.toml"
        text = resources.files("sim.scenario.shipped").joinpath("microsat.toml").read_text(encoding="utf-8")
        file.write_text(text.replace('name = "microsat"', 'name = "mine"'), encoding="utf-8")
        assert load(str(file)).name == "mine"

    def test_a_missing_file(self, tmp_path):
        assert "cannot be read (No such file or directory)" in fault(str(tmp_path / "x.toml"))

    @pytest.mark.parametrize("given", ["my3u.tml", "./my3u", "my3u."])
    def test_of_a_missing_file_with_another_ending_a_similar_one_is_named(self, tmp_path, monkeypatch, given):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "my3u.toml").touch()
        missing = "cannot be read (No such file or directory)"
        assert fault(given) == f"{Path(given)}: {missing}; did you mean my3u.toml?"

    def test_a_name_may_have_meant_a_file(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "mysat.toml").touch()
        assert "there is no scenario 'mysat' (did you mean 'mysat.toml'?): choose one of " in fault("mysat")

    @pytest.mark.parametrize("given", ["my3u.tml", "mine.txt", "mine." + 300 * "x", "\0/a.tml"])
    def test_what_is_near_no_file_or_is_one_of_another_kind_is_no_scenario(
        self, tmp_path, monkeypatch, given
    ):
        monkeypatch.chdir(tmp_path)
        (tmp_path / "mine.txt").touch()
        (tmp_path / "mine.toml").touch()
        assert f"there is no scenario {given!r}" in fault(given)

    def test_a_fault_in_a_file_bears_its_path(self, tmp_path):
        file = tmp_path / "mine.toml"
        text = resources.files("sim.scenario.shipped").joinpath("microsat.toml").read_text(encoding="utf-8")
        file.write_text(text.replace("angle_deg = 40.0", "angel_deg = 40.0"), encoding="utf-8")
        assert fault(str(file)) == f"{file}: initial.angel_deg is not a known key (did you mean 'angle_deg'?)"


class TestSettings:
    def test_values_are_toml(self):
        assert settings("time.tick_hz=10", "coils.pulse_s=2.5", "flight.estimator.bias=false") == {
            "time": {"tick_hz": 10},
            "coils": {"pulse_s": 2.5},
            "flight": {"estimator": {"bias": False}},
        }
        assert settings("body.inertia_kgm2=[1, 2.5, 3]") == {"body": {"inertia_kgm2": [1, 2.5, 3]}}
        assert settings('orbit.tle=["a", "b"]') == {"orbit": {"tle": ["a", "b"]}}

    def test_a_bare_word_is_a_text(self):
        assert settings("coils.backoff=per_coil") == {"coils": {"backoff": "per_coil"}}
        assert settings('coils.backoff="per_coil"') == {"coils": {"backoff": "per_coil"}}

    def test_blanks_and_further_equals_signs(self):
        assert settings(" time.tick_hz = 10 ") == {"time": {"tick_hz": 10}}
        assert settings("name=a=b") == {"name": "a=b"}

    def test_later_ones_win_and_sections_grow(self):
        assert settings("time.tick_hz=2", "time.orbits=3.0", "time.tick_hz=5") == {
            "time": {"tick_hz": 5, "orbits": 3.0}
        }

    def test_none(self):
        assert settings() == {}

    @pytest.mark.parametrize("text", ["novalue", "=3", "a..b=1", ".a=1", "a.=1", ""])
    def test_what_is_no_setting(self, text):
        with pytest.raises(TableError, match="write KEY=VALUE") as caught:
            settings(text)
        assert str(caught.value).startswith(f"--set {text}: ")

    @pytest.mark.parametrize(
        ("text", "told"),
        [
            ("time.tick_hz=0", "time.tick_hz = 0 is not allowed: allowed is a whole number at least 1"),
            ("time.tick_hz=fast", "time.tick_hz = 'fast' is not allowed"),
            ("time.tick_hz=", "time.tick_hz = '' is not allowed"),
            ("time.orbits=0", "time.orbits = 0 is not allowed: allowed is a number above 0"),
            ("sensors.magnetometer.noise_nt=-1", "sensors.magnetometer.noise_nt = -1 is not allowed"),
            ("sensors.gyro.noise=1", "sensors.gyro is not a known key"),
            ("initial.axis=[0,0,0]", "axis must not be zero"),
            ("initial.angle_deg=181", "at least -180 and at most 180"),
            ("disturbance.torque_nm=[0,0]", "disturbance.torque_nm.2 is missing"),
            ("orbit=5", "orbit = 5 is not allowed: allowed is a section of keys"),
            ("coils=shared", "coils = 'shared' is not allowed: allowed is a section of keys"),
            ("field.degree=14", "a whole number at least 1 and at most 13"),
            ("plant.max_substep_s=0", "a number at least 0.001 and at most 5"),
            ("coils.time_constant_s=0", "a number above 0"),
            ("knowledge=none", "'filter' or 'perfect'"),
            ("flight.modes.near=1", "[flight]: modes.near is not a known key"),
            ("flight.modes.near_deg=200", "[flight]: modes.near_deg = 200 is not allowed"),
            ("flight=3", "flight = 3 is not allowed: allowed is a section of keys"),
        ],
    )
    def test_a_malformed_setting_is_refused(self, text, told):
        sentence = fault(**settings(text))
        assert sentence.startswith("scenario microsat: ")
        assert told in sentence

    @pytest.mark.long
    @pytest.mark.parametrize("value", ["x", [], {"a": 1}, -1.0, nan, [[1]], [{"kind": 3}]], ids=repr)
    def test_no_key_answers_in_the_words_of_a_library(self, value):
        sentences = []
        for path in (*keys_of(Scenario), *(("flight", *path) for path in keys_of(FlightTable))):
            laid_over = value
            for part in reversed(path):
                laid_over = {part: laid_over}
            try:
                load("microsat", laid_over)
            except TableError as error:
                sentences.append(str(error))
        foreign = re.compile(r"nput should|tuple|validation|union|instance")
        assert [sentence for sentence in sentences if foreign.search(sentence)] == []
        assert len(sentences) > 100


class TestOrbit:
    @pytest.mark.parametrize("key", ["altitude_km", "inclination_deg", "raan_deg", "u0_deg"])
    def test_one_circular_key_replaces_the_elements(self, key):
        overrides = {"orbit": {"altitude_km": 700.0} | {key: 160.0}}
        orbit = load("microsat", overrides).orbit
        assert orbit.tle is None
        assert getattr(orbit, key) == 160.0
        others = {"inclination_deg", "raan_deg", "u0_deg"} - {key}
        assert all(getattr(orbit, other) == 0.0 for other in others)

    def test_an_inclination_alone_lacks_its_altitude(self):
        assert "altitude_km (150 to 40000)" in fault(orbit={"inclination_deg": 51.6})

    def test_elements_replace_a_circle(self):
        assert load("posat1", {"orbit": {"tle": list(TLE)}}).orbit.tle == TLE

    def test_both_at_once_are_refused(self):
        assert "either tle" in fault(orbit={"tle": list(TLE), "altitude_km": 700.0})

    def test_the_controller_flies_the_same_orbit(self):
        for name in NAMES:
            scenario = load(name)
            shared = scenario.orbit.model_dump(exclude={"along_track_km"})
            assert flight_table(scenario).orbit.model_dump() == shared

    @pytest.mark.parametrize("name", ["microsat", "cubesat3u"])
    def test_how_far_the_satellite_is_ahead_of_it_is_unknown_on_board(self, name):
        wrong = load(name, {"orbit": {"along_track_km": -12.5}})
        assert wrong.orbit.along_track_km == -12.5
        assert flight_table(wrong) == flight_table(load(name))

    def test_being_ahead_does_not_replace_the_elements(self):
        assert load("microsat", {"orbit": {"along_track_km": 5.0}}).orbit.tle == TLE

    def test_period(self):
        assert orbit_period_s(load("microsat")) == pytest.approx(86400.0 / 14.30166407)
        circle = load("microsat", {"orbit": {"altitude_km": 800.0}})
        assert orbit_period_s(circle) == pytest.approx(6052.4, abs=0.1)


class TestEpoch:
    def test_of_elements_is_theirs_rounded_up(self):
        assert load("microsat").epoch_unix_s == int(datetime(2015, 3, 27, 2, 46, 57, tzinfo=UTC).timestamp())

    def test_named(self):
        scenario = load("microsat", settings("time.epoch_utc=2015-04-01T00:00:00Z"))
        assert scenario.epoch_unix_s == int(datetime(2015, 4, 1, tzinfo=UTC).timestamp())

    @pytest.mark.parametrize("name", NAMES)
    def test_controller_and_plant_have_one_clock(self, name):
        scenario = load(name)
        assert flight_table(scenario).epoch_unix_s == plant_config(scenario, 1).epoch_unix_s

    def test_also_where_the_controller_believes_in_older_elements(self):
        older = TLE[0].replace("15086.11593543", "15084.11593543")[:68]
        older += str(sum(int(c) if c.isdigit() else c == "-" for c in older) % 10)
        scenario = load("microsat", {"flight": {"orbit": {"tle": [older, TLE[1]]}}})
        table = flight_table(scenario)
        assert table.orbit.tle == (older, TLE[1])
        assert table.epoch_unix_s == scenario.epoch_unix_s


class TestOnboardTable:
    def test_what_is_shared_is_written_once(self):
        scenario = load(
            "microsat",
            settings(
                "time.tick_hz=4", "coils.backoff=per_coil", "control.k_a=1000", "field.model=direct_dipole"
            ),
        )
        table = flight_table(scenario)
        assert table.time.tick_hz == 4
        assert table.coils.backoff == "per_coil"
        assert table.control.k_a == 1000.0
        assert table.field.model == "direct_dipole"
        assert table.body.inertia_kgm2 == scenario.body.inertia_kgm2

    def test_the_plant_gets_the_same_limits(self):
        scenario = load(
            "microsat", settings("coils.backoff=per_coil", "coils.pulse_s=2.5", "coils.backoff_s=90")
        )
        limits = plant_config(scenario, 1).limits
        assert (limits.pulse_ms, limits.backoff_ms, limits.shared) == (2500, 90000, False)

    def test_flight_values_are_the_controller_s_alone(self):
        scenario = load("microsat", settings("flight.body.inertia_kgm2=[1.1, 1.9, 2.0]"))
        assert flight_table(scenario).body.inertia_kgm2 == (1.1, 1.9, 2.0)
        assert plant_config(scenario, 1).body.inertia_kgm2[0][0] == 1.02

    @pytest.mark.parametrize(("noise_nt", "noise_deg"), [(200.0, 0.5), (1000.0, 2.0), (0.0, 0.0)])
    def test_the_filter_expects_the_sensors_noise_and_no_less_than_its_models_errors(
        self, noise_nt, noise_deg
    ):
        table = flight_table(
            load(
                "microsat",
                settings(f"sensors.magnetometer.noise_nt={noise_nt}", f"sensors.sun.noise_deg={noise_deg}"),
            )
        )
        assert table.estimator.magnetometer_sigma_nt == pytest.approx(hypot(noise_nt, 20.0))
        assert table.estimator.sun_sigma_deg == pytest.approx(hypot(noise_deg, 0.02))

    @pytest.mark.parametrize(
        ("steps", "expected"),
        [((2.0, 0.0, 0.0), (0.0, 0.0, 0.0)), ((200.0, 0.004, 5.0), (200.0, 0.004, 5.0))],
        ids=["of the bus", "coarser"],
    )
    def test_the_table_has_the_steps_of_readings_that_are_coarser_than_the_bus(self, steps, expected):
        field_nt, sun, percent = steps
        table = flight_table(
            load(
                "microsat",
                settings(
                    f"sensors.magnetometer.quantum_nt={field_nt}",
                    f"sensors.sun.quantum={sun}",
                    f"sensors.cells={{normals=[[1, 0, 0]], quantum_percent={percent}}}",
                ),
            )
        )
        tuning = table.estimator
        found = (tuning.magnetometer_quantum_nt, tuning.sun_quantum, table.cells.quantum_percent)
        assert found == expected

    def test_the_steps_of_the_bus_are_those_of_its_messages(self):
        field, sun = MagField(1, 0.9, 2.9, 0.0, counter=0), SunVector(1, 0.0, 1.9 / 2**14, 0.0, counter=0)
        assert MagField.decode(field.encode().data).values()[1:3] == (0.0, BUS_STEP_NT)
        assert SunVector.decode(sun.encode().data).s_y == 2.0 * BUS_STEP_SUN
        assert 100.0 * QUANTUM == BUS_STEP_PERCENT

    def test_flight_values_win_over_what_is_derived(self):
        table = flight_table(load("microsat", settings("flight.estimator.sun_sigma_deg=3.0")))
        assert table.estimator.sun_sigma_deg == 3.0

    def test_a_scenario_cannot_be_changed_after_it_was_checked(self):
        with pytest.raises(ValueError, match="frozen"):
            load("microsat").name = "x"
