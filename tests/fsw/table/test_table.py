"""The onboard table: the default one is sound, every planted error is told, the epoch is the right one."""

import re
from dataclasses import asdict, fields
from datetime import UTC, datetime
from importlib import resources

import pytest

from fsw.core.laws.table import LAWS
from fsw.input.schema import TableError, merge
from fsw.table.calibration import CalibrationTable
from fsw.table.config import flight_config
from fsw.table.sections import parse_utc
from fsw.table.table import (
    DEFAULT_EPOCH_UTC,
    FlightTable,
    default_values,
    flight_table,
    lay_over,
    load_flight_table,
)
from fsw.table.uncertainty import UncertaintyTable, bounds


def default_text():
    return (resources.files("fsw") / "flight.toml").read_text(encoding="utf-8")


TLE = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)
CIRCULAR = {"orbit": {"altitude_km": 700.0, "inclination_deg": 98.2, "raan_deg": 10.0, "u0_deg": 20.0}}


def nested(key, value):
    for part in reversed(key.split(".")):
        value = {part: value}
    return value


def fault(values, source="table.toml"):
    with pytest.raises(TableError) as caught:
        flight_table(values, source)
    return str(caught.value)


class TestDefault:
    def test_is_sound(self):
        table = load_flight_table(None)
        assert table.time.tick_hz == 1
        assert table.orbit.tle == TLE

    def test_who_changes_its_values_changes_no_others(self):
        values = default_values()
        values["time"]["tick_hz"] = 99
        values.pop("orbit")
        assert default_values()["time"]["tick_hz"] == 1
        assert default_values()["orbit"] == {"tle": list(TLE)}

    def test_every_key_of_the_schema_is_written_in_it(self):
        """So that who reads the file sees all that can be set."""
        values = default_values()
        optional = {
            "time.epoch_utc",
            "control.spin_radps",
            "control.gains",
            "control.law_sha256",
            "control.law_withheld",
            "coils.max_dipole_am2",
        } | {f"orbit.{key}" for key in ("altitude_km", "inclination_deg", "raan_deg", "u0_deg")}
        optional |= {f"uncertainty.{key}" for key in UncertaintyTable.model_fields}
        optional |= {f"calibration.{key}" for key in CalibrationTable.model_fields}
        for name, field in FlightTable.model_fields.items():
            inner = getattr(field.annotation, "model_fields", None)
            for key in inner or ():
                assert key in values[name] or f"{name}.{key}" in optional, f"{name}.{key}"

    def test_the_bounds_are_written_in_it_as_ordinary_values_left_out(self):
        """As comments, since the ordinary value of a bound depends on the satellite's size."""
        text = default_text()
        written = dict(re.findall(r"^# (\w+) = ([\d.e-]+)", text, re.MULTILINE))
        assert list(written) == list(UncertaintyTable.model_fields)
        table = load_flight_table(None)
        as_written = UncertaintyTable(**{key: float(value) for key, value in written.items()})
        of_default = bounds(table.uncertainty, table.ordinary)
        for field in fields(of_default):
            given = getattr(bounds(as_written, table.ordinary), field.name)
            assert getattr(of_default, field.name) == pytest.approx(given, rel=0.05)

    def test_a_file_may_hold_what_differs_alone(self, tmp_path):
        file = tmp_path / "mine.toml"
        file.write_text("[control]\nk_a = 1000.0\n", encoding="utf-8")
        assert load_flight_table(str(file)) == flight_table({"control": {"k_a": 1000.0}}, "x")
        assert load_flight_table(str(file)).control.k_w == load_flight_table(None).control.k_w

    def test_a_fault_in_a_file_bears_its_name(self, tmp_path):
        file = tmp_path / "mine.toml"
        file.write_text("[control]\nk_x = 1000.0\n", encoding="utf-8")
        with pytest.raises(TableError, match=r"mine\.toml: control\.k_x is not a known key"):
            load_flight_table(str(file))


WITH_GAINS = "allowed: " + ", ".join(name for name, row in LAWS.items() if row.gains is not None)
OF_THREE_TERM = "allowed: " + ", ".join(field.name for field in fields(LAWS["three_term"].gains))

PLANTED = [
    ("tick_hz", 5, "tick_hz is not a known key"),
    ("time.rate", 5, "time.rate is not a known key"),
    ("time.tick_hz", 0, "a whole number at least 1 and at most 100"),
    ("time.tick_hz", 101, "a whole number at least 1 and at most 100"),
    ("time.tick_hz", "10", "a whole number at least 1 and at most 100"),
    ("time.tick_hz", True, "a whole number at least 1 and at most 100"),
    ("time.tick_hz", 10.0, "a whole number at least 1 and at most 100"),
    ("time.epoch_utc", "yesterday", "'yesterday' is not a time such as 2025-03-20T12:00:00Z"),
    ("time.epoch_utc", "2025-03-20T12:00:00.5Z", "is not a whole second"),
    ("time.epoch_utc", 1_700_000_000, "time.epoch_utc = 1700000000 is not allowed: allowed is a text"),
    ("orbit.altitude_km", 149.0, "a number at least 150 and at most 40000"),
    ("orbit.inclination_deg", 181.0, "a number at least 0 and at most 180"),
    ("orbit.raan_deg", 360.5, "a number at least -360 and at most 360"),
    ("orbit.raan_deg", -360.5, "a number at least -360 and at most 360"),
    ("orbit.u0_deg", 360.5, "a number at least -360 and at most 360"),
    ("orbit.u0_deg", -360.5, "a number at least -360 and at most 360"),
    ("orbit.tle", list(TLE[:1]), "orbit.tle.1 is missing"),
    ("orbit.tle", [TLE[0][:-1] + "3", TLE[1]], "checksum"),
    ("orbit.tle", [TLE[1], TLE[0]], "element line 1"),
    ("field.model", "wmm", "'igrf14', 'tilted_dipole' or 'direct_dipole'"),
    ("field.degree", 11, "a whole number at least 1 and at most 10"),
    ("body.inertia_kgm2", [1.0, 2.0], "three principal moments or 3 x 3 numbers"),
    ("body.inertia_kgm2", "1, 2, 3", "three principal moments or 3 x 3 numbers"),
    ("body.inertia_kgm2", [1.0, 2.0, "3"], "three principal moments or 3 x 3 numbers"),
    ("body.inertia_kgm2", [[1, 0, 0], [0, 1, 0]], "three principal moments or 3 x 3 numbers"),
    ("body.inertia_kgm2", [1.0, 2.0, 4.0], "no principal moment above the sum of the others"),
    ("body.inertia_kgm2", [0.0, 2.0, 2.0], "must be positive"),
    ("body.inertia_kgm2", [[1, 0.1, 0], [0.2, 2, 0], [0, 0, 2]], "must be symmetric"),
    ("coils.levels_am2", [1.0, 2.0], "coils.levels_am2.2 is missing"),
    ("coils.levels_am2", [1.0, 2.0, 2.0], "three positive, rising dipoles"),
    ("coils.levels_am2", [2.0, 1.0, 3.0], "three positive, rising dipoles"),
    ("coils.levels_am2", [1.0, 1.0, 3.0], "three positive, rising dipoles"),
    ("coils.levels_am2", [0.0, 1.0, 3.0], "three positive, rising dipoles"),
    ("coils.levels_am2", [-1.0, 1.0, 3.0], "three positive, rising dipoles"),
    ("coils.pulse_s", 3.001, "a number above 0 and at most 3"),
    ("coils.pulse_s", 0.0, "a number above 0 and at most 3"),
    ("coils.backoff_s", -1.0, "a number at least 0"),
    ("coils.backoff_s", 161.0, "at most 160"),
    ("coils.backoff", "none", "'shared' or 'per_coil'"),
    ("control.law", "magic", "three_axis (pd,"),
    ("control.k_w", -1.0, "a number at least 0"),
    ("control.k_a", "1.0", "a number at least 0"),
    ("control.k_a", float("inf"), "a number at least 0"),
    ("control.spin_radps", 0.11, "a number at least -0.1 and at most 0.1"),
    ("control.spin_radps", -0.11, "a number at least -0.1 and at most 0.1"),
    ("control.k_i", -1.0, "a number at least 0"),
    ("control.minimiser", "simplex", "'closed_form' or 'genetic'"),
    ("control.gains", {"magic": {"r": 1.0}}, f"gains.magic: no such law has gains of its own ({WITH_GAINS})"),
    ("control.gains", {"magic": {}}, f"gains.magic: no such law has gains of its own ({WITH_GAINS})"),
    ("control.gains", {"pd": {"k_w": 1.0}}, f"gains.pd: no such law has gains of its own ({WITH_GAINS})"),
    ("control.gains", {"three_term": {"k_x": 1.0}}, f"gains.three_term: k_x is not known ({OF_THREE_TERM})"),
    ("control.gains", {"three_term": {"k_x": "1"}}, "a number"),
    ("control.gains", {"three_term": 1.0}, "a section of keys"),
    ("control.leak_s", 0.0, "a number above 0"),
    ("control.law", "two_coils", "is not allowed without [wheel]: it asks for torques of a driven wheel"),
    ("control.law", "dual_spin", "is not allowed without body.wheel_nms along the orbit's normal: it holds"),
    ("coils.driver", "analog", "'pulsed' or 'continuous'"),
    ("coils.driver", "continuous", "a continuous driver needs max_dipole_am2"),
    ("coils.max_dipole_am2", 0.0, "a number above 0"),
    ("coils.on_fraction", 0.0, "a number above 0 and at most 1"),
    ("coils.on_fraction", 1.1, "a number above 0 and at most 1"),
    ("estimator.sun_sigma_deg", 0.0, "a number above 0"),
    ("estimator.rate_sigma_degps", -1.0, "a number above 0"),
    ("estimator.magnetometer_quantum_nt", -1.0, "a number at least 0"),
    ("estimator.sun_quantum", float("nan"), "a number at least 0"),
    ("estimator.bias", True, "estimator.bias is not a known key"),
    ("uncertainty.inertia_percent", 30.1, "a number at least 0 and at most 30"),
    ("uncertainty.residual_dipole_am2", -0.1, "a number at least 0"),
    ("uncertainty.torque_nm", "small", "a number at least 0"),
    ("uncertainty.dipole_am2", 0.1, "uncertainty.dipole_am2 is not a known key"),
    ("modes.near_deg", 40.0, "near_deg under far_deg"),
    ("modes.slow_degps", 0.6, "slow_degps must lie under fast_degps"),
    ("modes.near_deg", 181.0, "a number above 0 and at most 180"),
    ("modes.far_deg", 180.5, "a number above 0 and at most 180"),
    ("modes.recover_s", -1.0, "a number at least 0"),
    ("modes.stale_after_s", 0.0, "a number above 0"),
    ("modes.trips_to_stay_safe", 0, "a whole number at least 1"),
    ("telemetry.ephemeris_s", 9, "a whole number at least 10 and at most 30"),
    ("telemetry.ephemeris_s", 31, "a whole number at least 10 and at most 30"),
    ("telemetry.attitude_s", -0.1, "a number at least 0"),
    ("fdir.false_alarm_days", 0.5, "a number at least 1 and at most 36525"),
    ("fdir.weak_coil_part", 1.0, "a number above 0.2 and below 1"),
    ("coils.dipole_per_ampere_am2", 0.0, "a number above 0"),
    ("fdir.second_sender_s", 0.0, "a number above 0"),
    ("fdir.event_spacing_s", -1.0, "a number at least 0"),
    ("fdir.silent_s", 60.0, "fdir.silent_s is not a known key"),
    ("knowledge", "guess", "'filter' or 'perfect'"),
    ("coils", 3, "coils = 3 is not allowed: allowed is a section of keys"),
]


@pytest.mark.parametrize(("key", "value", "allowed"), PLANTED, ids=[f"{k}={v}" for k, v, _ in PLANTED])
def test_a_planted_error_is_told_in_one_sentence(key, value, allowed):
    sentence = fault(nested(key, value))
    assert sentence.startswith("table.toml: ")
    assert key.split(".")[-1] in sentence or key.split(".")[0] in sentence
    assert allowed in sentence
    assert "\n" not in sentence
    assert ";" not in sentence


class TestGains:
    def test_of_a_law_are_taken_and_the_others_keep_their_defaults(self):
        table = flight_table({"control": {"gains": {"three_term": {"k_spin": 7.0}}}}, "x")
        gains = flight_config(table).control.gains
        defaults = LAWS["three_term"].gains()
        assert asdict(gains["three_term"]) == asdict(defaults) | {"k_spin": 7.0}
        assert defaults.k_spin != 7.0

    def test_every_law_that_has_some_has_them_without_a_word(self):
        gains = flight_config(flight_table({}, "x")).control.gains
        assert gains == {name: row.gains() for name, row in LAWS.items() if row.gains is not None}
        assert gains

    @pytest.mark.parametrize(
        ("law", "wrong"),
        [
            ("lqr", {"effort": 0.0}),
            ("lqg_field", {"effort": 0.0}),
            ("mpc_fitted", {"horizon_orbits": 9.0}),
            ("two_step", {"done_deg": 20.0}),
            ("six_gain", {"k2": 99.0}),
            ("phasing", {"level": 2.5}),
        ],
    )
    def test_that_a_law_does_not_take_are_told_with_its_section(self, law, wrong):
        """Of a law whose gains are another's in form too."""
        told = fault({"control": {"gains": {law: wrong}}}, "mine.toml")
        assert told.startswith(f"mine.toml: control: gains.{law}: ")
        assert next(iter(wrong)) in told

    def test_they_count_in_the_checksum(self):
        other = flight_table({"control": {"gains": {"three_term": {"k_spin": 7.0}}}}, "x")
        assert other.crc != flight_table({}, "x").crc


class TestOrbit:
    def test_a_circular_orbit_replaces_the_default_s_elements(self):
        table = flight_table(CIRCULAR, "x")
        assert table.orbit.tle is None
        assert (table.orbit.altitude_km, table.orbit.u0_deg) == (700.0, 20.0)

    def test_elements_replace_a_circular_orbit(self):
        base = lay_over(default_values(), CIRCULAR)
        laid = lay_over(base, {"orbit": {"tle": list(TLE)}})
        assert laid["orbit"] == {"tle": list(TLE)}

    def test_one_key_of_the_same_kind_leaves_the_others(self):
        base = lay_over(default_values(), CIRCULAR)
        assert lay_over(base, {"orbit": {"u0_deg": 5.0}})["orbit"] == {**CIRCULAR["orbit"], "u0_deg": 5.0}

    def test_angles_that_are_not_given_are_zero(self):
        orbit = flight_table({"orbit": {"altitude_km": 700.0}}, "x").orbit
        assert (orbit.inclination_deg, orbit.raan_deg, orbit.u0_deg) == (0.0, 0.0, 0.0)

    def test_a_section_that_says_nothing_changes_nothing(self):
        assert flight_table({"orbit": {}}, "x").orbit.tle == TLE

    def test_both_kinds_at_once_are_refused(self):
        sentence = fault({"orbit": {"tle": list(TLE), "altitude_km": 700.0}})
        assert (
            sentence
            == "table.toml: orbit: an orbit needs either tle (two lines) or altitude_km (150 to 40000)"
        )

    def test_an_inclination_without_an_altitude_is_refused(self):
        assert "altitude_km" in fault({"orbit": {"inclination_deg": 51.6}})


class TestEpoch:
    def unix(self, *moment):
        return int(datetime(*moment, tzinfo=UTC).timestamp())

    def test_is_the_elements_unless_it_is_named(self):
        assert flight_table({}, "x").epoch_unix_s == self.unix(2015, 3, 27, 2, 46, 57)
        named = {"time": {"epoch_utc": "2015-04-01T00:00:00Z"}}
        assert flight_table(named, "x").epoch_unix_s == self.unix(2015, 4, 1)

    def test_of_a_circular_orbit_that_names_none(self):
        assert flight_table(CIRCULAR, "x").epoch_unix_s == parse_utc(DEFAULT_EPOCH_UTC)

    @pytest.mark.parametrize(
        ("text", "moment"),
        [
            ("2025-03-20T12:00:00Z", (2025, 3, 20, 12)),
            ("2025-03-20T12:00:00", (2025, 3, 20, 12)),
            ("2025-03-20 12:00:00", (2025, 3, 20, 12)),
            ("2025-03-20T14:00:00+02:00", (2025, 3, 20, 12)),
            ("2025-03-20", (2025, 3, 20)),
        ],
    )
    def test_utc_as_people_write_it(self, text, moment):
        assert parse_utc(text) == self.unix(*moment)

    @pytest.mark.parametrize("text", ["", "now", "20.3.2025", "2025-13-01", "2025-03-20T25:00:00Z"])
    def test_what_is_no_time(self, text):
        with pytest.raises(ValueError, match="is not a time such as"):
            parse_utc(text)

    def test_toml_s_own_times_serve_too(self, tmp_path):
        for written in ("2025-03-20T12:00:00Z", "2025-03-20T12:00:00", '"2025-03-20T12:00:00Z"'):
            file = tmp_path / "t.toml"
            file.write_text(f"[time]\nepoch_utc = {written}\n", encoding="utf-8")
            assert load_flight_table(str(file)).epoch_unix_s == self.unix(2025, 3, 20, 12)


@pytest.mark.parametrize(
    ("coils", "allowed"),
    [
        ({"levels_am2": [10.0, 20.0, 40.94]}, True),
        ({"levels_am2": [10.0, 20.0, 40.96]}, False),
        ({"levels_am2": [0.034, 2.0, 8.0]}, True),
        ({"levels_am2": [0.033, 2.0, 8.0]}, False),
        ({"levels_am2": [10.0, 20.0, 90.0], "driver": "continuous", "max_dipole_am2": 90.0}, True),
    ],
)
def test_currents_of_pulses_fit_into_their_report(coils, allowed):
    """2047 mA at most; and at least so much that, rounded to 1 mA, a sound coil has 0.7 of it: 1.67 mA."""
    if allowed:
        assert flight_table({"coils": coils}, "table.toml").coils.levels_am2 == tuple(coils["levels_am2"])
        return
    said = fault({"coils": coils})
    assert said.startswith(
        "table.toml: coils.levels_am2 at coils.dipole_per_ampere_am2 = 20 are currents of "
    )
    assert "allowed is 1.67 to 2047 mA" in said


def test_no_spin_unless_it_is_asked_for():
    assert flight_table({}, "x").control.spin_radps == 0.0
    assert flight_table({"control": {"spin_radps": -0.1}}, "x").control.spin_radps == -0.1


class TestInertia:
    def test_three_moments_are_a_diagonal_tensor(self):
        table = flight_table({"body": {"inertia_kgm2": [1.02, 1.85, 1.95]}}, "x")
        assert table.body.inertia == ((1.02, 0.0, 0.0), (0.0, 1.85, 0.0), (0.0, 0.0, 1.95))

    def test_a_full_tensor_is_taken_as_it_is(self):
        full = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
        assert flight_table({"body": {"inertia_kgm2": [list(row) for row in full]}}, "x").body.inertia == full


class TestChecksum:
    def test_is_the_same_for_the_same_table(self):
        assert flight_table({}, "x").crc == flight_table({}, "y").crc == load_flight_table(None).crc
        assert 0 <= load_flight_table(None).crc < 2**32

    def test_every_value_counts(self):
        values = default_values()
        sums, count = {flight_table({}, "x").crc}, 1
        for section, content in values.items():
            for key, value in content.items() if isinstance(content, dict) else ():
                if isinstance(value, bool):
                    other = not value
                elif isinstance(value, float):
                    other = 1.0001 * value + 1e-12 if key != "pulse_s" else 0.999 * value
                elif isinstance(value, int):
                    other = value - 1 if value > 1 else value + 1
                else:
                    continue
                count += 1
                sums.add(flight_table({section: {key: other}}, "x").crc)
        assert count >= 34
        assert len(sums) == count

    @pytest.mark.parametrize("key", ["magnetometer_quantum_nt", "sun_quantum"])
    def test_a_step_counts_where_there_is_one(self, key):
        without = flight_table({}, "x").crc
        assert flight_table({"estimator": {key: 0.0}}, "x").crc == without
        assert flight_table({"estimator": {key: 0.5}}, "x").crc != without

    def test_how_a_number_is_written_does_not(self):
        assert flight_table(merge({}, {"coils": {"pulse_s": 3}}), "x").crc == flight_table({}, "x").crc
