"""A calibration from a log: a body that turns along its orbit, its channels wired, skewed and late."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomli_w
from scipy.spatial.transform import Rotation

from fsw.table.table import flight_table
from sim.commissioning.calibrate.flown.expected import expected
from sim.commissioning.calibrate.flown.run_fit import calibrated, field_sigma_nt_per_am2
from sim.commissioning.calibrate.flown.samples import Samples
from sim.commissioning.calibrate.flown.tables import tables
from sim.commissioning.calibrate.flown.verdicts import list_undetermined, sentences, turn_rad
from sim.commissioning.calibrate.flown.wiring import channels_from_body
from sim.errors import HarnessError

TABLE = flight_table({}, "table.toml")
WIRING = (-2, 3, 1)
OFFSET = np.array([24000.0, -31000.0, 9000.0])
ERRORS = Rotation.from_rotvec([0.01, -0.02, 0.015]).as_matrix() @ np.array(
    [[1.03, 0.01, -0.015], [0.01, 0.97, 0.02], [-0.015, 0.02, 1.01]]
)
CHANNELS_FROM_BODY = channels_from_body(WIRING) @ np.linalg.inv(ERRORS)
OWN = np.array([[1800.0, -300.0, 90.0], [-700.0, 1500.0, 600.0], [250.0, -900.0, -2100.0]])
DELAY = 1.4


RATE = (0.006, -0.004, 0.007)


def turned(vectors, at_s, rate=RATE):
    """In body axes at these times."""
    turns = Rotation.from_rotvec(np.outer(at_s, rate)) * Rotation.from_rotvec([0.3, 1.1, -0.7])
    return turns.apply(vectors)


def log(ticks=1500, rate=RATE, seed=3, pulses=True):
    draw, k = np.random.default_rng(seed), np.arange(ticks)
    unix_s = TABLE.epoch_unix_s + k.astype(float)
    along = expected(TABLE, unix_s)
    late = expected(TABLE, unix_s - DELAY)

    coil, level = k % 3, np.zeros(ticks, dtype=int)
    for number, begin in enumerate(range(100, ticks - 60, 103) if pulses else ()):
        coil[begin : begin + 3], level[begin : begin + 3] = number % 3, 3 if number // 3 % 2 == 0 else -3
    driven = np.zeros((ticks, 3))
    driven[k, coil] = np.array([0.0, 0.5, 2.0, 8.0])[np.abs(level)] * np.sign(level)
    whole, part = int(DELAY), DELAY - int(DELAY)
    shown = (1 - part) * np.roll(driven, whole, axis=0) + part * np.roll(driven, whole + 1, axis=0)
    z = (turned(late.b_eci_nt, k - DELAY, rate) + shown @ OWN.T) @ CHANNELS_FROM_BODY.T + OFFSET
    sun = turned(along.sun_eci, k, rate)
    sun = sun + np.cross(sun, draw.normal(size=sun.shape) * np.radians(0.5))
    field = z + 200.0 * draw.normal(size=z.shape)
    return Samples(k, unix_s, field, sun, coil, level, np.ones(ticks, bool))


@pytest.fixture(scope="module")
def found():
    return calibrated(log(), TABLE)


@pytest.mark.long
def test_the_wiring_is_found_first(found):
    assert found.wiring == WIRING


def test_true_values_are_within_what_it_says(found):
    sigma = np.sqrt(found.field.covariance.diagonal())
    true = np.linalg.inv(CHANNELS_FROM_BODY)
    off = [
        (found.field.matrix - true).ravel() / sigma[:9],
        (found.field.offset_nt - OFFSET) / sigma[9:],
        ((found.field_nt_per_am2 - OWN) / found.field_sigma).ravel(),
        [(found.response.delay_ticks - DELAY) / found.response.delay_sigma],
    ]
    assert np.abs(np.concatenate(off)).max() < 4.5
    assert np.mean(np.abs(np.concatenate(off)) < 3.0) >= 0.95


def test_the_coils_field_is_known_no_better_than_matrix_and_response_together(found):
    draw, root = np.random.default_rng(5), np.linalg.cholesky(40.0 * found.field.covariance[:9, :9])
    badly = replace(found.field, covariance=40.0 * found.field.covariance)
    said = field_sigma_nt_per_am2(badly, found.response)
    products = []
    for _ in range(2000):
        matrix = found.field.matrix + (root @ draw.normal(size=9)).reshape(3, 3)
        response = found.response.nt_per_am2 + found.response.sigma * draw.normal(size=(3, 3))
        products.append(matrix @ response)
    assert said == pytest.approx(np.std(products, axis=0), rel=0.08)


@pytest.mark.long
def test_a_short_log_of_a_sensor_noisier_than_the_table_says_is_less_sure():
    short = log(ticks=700)
    noise = 570.0 * np.random.default_rng(9).normal(size=short.field_nt.shape)
    found = calibrated(replace(short, field_nt=short.field_nt + noise), TABLE)
    sigma = np.sqrt(found.field.covariance.diagonal())
    off = np.concatenate(
        [
            (found.field.matrix - np.linalg.inv(CHANNELS_FROM_BODY)).ravel() / sigma[:9],
            (found.field.offset_nt - OFFSET) / sigma[9:],
        ]
    )
    assert len(found.residual_nt) < 200
    assert found.widened > 2.5
    assert np.abs(off).max() < 3.0


def test_what_it_says_is_worth_something(found):
    sigma = np.sqrt(found.field.covariance.diagonal())
    assert sigma[:9].max() < 0.01
    assert sigma[9:].max() < 300.0
    assert found.field_sigma.max() < 30.0
    assert found.left_out < 0.01
    assert np.sqrt(np.nanmean(found.residual_nt**2, axis=0)) == pytest.approx([90.0, 150.0], rel=0.4)


def test_the_turn_is_that_of_the_sensor_against_the_sun_sensor(found):
    assert turn_rad(found) == pytest.approx([0.01, -0.02, 0.015], abs=0.006)


def test_the_tables_are_taken_by_the_onboard_table(found):
    text = tomli_w.dumps(tables(found, TABLE))
    table = flight_table(tomllib.loads(text), "calibration.toml")
    assert np.array(table.calibration.magnetometer.matrix) == pytest.approx(found.field.matrix, abs=1e-6)
    assert table.calibration.coils.field_delay_s == pytest.approx(DELAY, abs=0.03)
    assert DELAY < table.uncertainty.latency_s < DELAY + 0.1
    assert 100.0 <= table.uncertainty.magnetometer_bias_nt < 1000.0


@pytest.mark.parametrize(("late", "said"), [(2.9, None), (3.4, "3.43 s old"), (2.99, "3.02 s old")])
def test_a_field_that_is_later_than_the_onboard_table_admits_gives_no_table(found, late, said):
    response = replace(found.response, delay_ticks=late, delay_sigma=0.01)
    later = replace(found, response=response)
    if said is None:
        assert tables(later, TABLE)["uncertainty"]["latency_s"] == pytest.approx(2.93)
        return
    with pytest.raises(HarnessError, match=rf"no table is written: .* {said}"):
        tables(later, TABLE)


def test_it_is_said_in_words(found):
    text = "\n".join(sentences(found, 1.0))
    assert "samples of the field are 1.40" in text
    assert "turn against the Sun sensor" in text


@pytest.mark.long
def test_without_pulses_field_and_delay_are_not_told():
    text = list_undetermined(calibrated(replace_delay(log(pulses=False)), TABLE))
    assert sum("gave no pulse" in one for one in text) == 3
    assert any("delay is not known" in one for one in text)


def replace_delay(samples):
    """Readings of now: without pulses nobody knows how late they are."""
    along = expected(TABLE, samples.unix_s)
    z = turned(along.b_eci_nt, samples.tick) @ CHANNELS_FROM_BODY.T + OFFSET
    return replace(samples, field_nt=z + 200.0 * np.random.default_rng(8).normal(size=z.shape))


@pytest.mark.long
@pytest.mark.slow
def test_a_short_log_of_a_body_that_turns_about_one_axis_leaves_an_offset_and_gives_no_table():
    short = calibrated(log(ticks=420, rate=(0.0, 0.001, 0.003)), TABLE)
    assert any("the offset along" in one for one in list_undetermined(short))
    with pytest.raises(HarnessError, match="no table is written"):
        tables(short, TABLE)


@pytest.mark.long
@pytest.mark.slow
def test_one_that_hardly_turns_does_not_even_tell_the_wiring():
    with pytest.raises(HarnessError, match="wirings explain it alike"):
        calibrated(log(ticks=420, rate=(0.0, 0.0, 2e-4)), TABLE)


def test_dipoles_that_are_none_of_coils_are_not_written(found):
    """The pulses of this log turned nothing."""
    assert "matrix" not in tables(found, TABLE)["calibration"]["coils"]
    assert any("no dipoles of coils" in one for one in list_undetermined(found))


@pytest.mark.long
def test_in_the_dark_nothing_is_claimed():
    dark = log()
    with pytest.raises(HarnessError, match="the Sun was seen in 0 samples"):
        calibrated(replace(dark, sun=np.full_like(dark.sun, np.nan)), TABLE)


@pytest.mark.long
def test_outliers_are_left_out(found):
    bad = log()
    field = bad.field_nt.copy()
    field[700:703] += 30000.0
    again = calibrated(replace(bad, field_nt=field), TABLE)
    assert 0.0 < again.left_out < 0.05
    sigma = np.sqrt(found.field.covariance.diagonal())
    assert (np.abs(again.field.offset_nt - found.field.offset_nt) < 3.0 * sigma[9:]).all()


def test_an_offset_that_leaves_too_little_of_the_range_is_told(found):
    """31 uT of 65 leave 34, less the scale; the field of the log is of 45 uT and more over the poles."""
    measurable_nt = found.measurable_nt
    assert measurable_nt == pytest.approx((65000.0 - 31000.0) * 1.0, rel=0.06)
    weak, strong = (replace(found, strongest_nt=part * measurable_nt) for part in (0.99, 1.01))
    assert not any("end of its range" in line for line in sentences(weak, 1.0))
    (line,) = [line for line in sentences(strong, 1.0) if "end of its range" in line]
    assert line.startswith(f"in a field above {measurable_nt / 1000.0:.1f} uT")


def test_the_range_that_the_table_gives_stays(found):
    given = flight_table({"calibration": {"magnetometer": {"range_nt": 64000.0}}}, "table.toml")
    assert tables(found, given)["calibration"]["magnetometer"]["range_nt"] == 64000.0
    assert "range_nt" not in tables(found, TABLE)["calibration"]["magnetometer"]
