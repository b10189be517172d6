"""The flight filter over a pass: what it finds of a motion that is known, and what it predicts."""

import numpy as np
import pytest
from recorded_samples import AXES, MATRIX, OFFSET_NT, RATIOS, TLE, made_up
from scipy.spatial.transform import Rotation

from sim.commissioning.recorded.along import along
from sim.commissioning.recorded.calibration import PassCalibration
from sim.commissioning.recorded.recorded_pass import read_pass
from sim.commissioning.telemetry.follow import Noise, directions_body, filter_config, follow, without_sample
from sim.commissioning.telemetry.spin import Spin
from sim.errors import HarnessError
from sim.scenario.element_file import nearest_elements

KNOWN = PassCalibration(OFFSET_NT, MATRIX, (), AXES @ np.diag(RATIOS) @ AXES.T)
NOISE = Noise(field_nt=200.0)


def started(truth, off_deg=5.0):
    """From a little off the truth, the wobble unknown."""
    off = Rotation.from_rotvec(np.radians(off_deg) * np.array([0.6, -0.64, 0.48])).as_matrix()
    rate = float(np.degrees(truth.omega_radps[0] @ AXES[:, 1]))
    return Spin(rate, 0.0, off @ truth.dcm[0], np.radians(rate) * AXES[:, 1], np.zeros(3))


def noise_deg(truth):
    """What the noise of a sample, across the field, makes of its direction."""
    return np.degrees(150.0 * np.sqrt(2.0) / np.linalg.norm(truth.b_eci_nt, axis=1).mean())


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    truth = made_up(150)
    around = truth.along(tmp_path_factory.mktemp("pass"))
    start = started(truth)
    return truth, around, follow(around, KNOWN, start, filter_config(KNOWN.inertia, 1.0, NOISE))


def test_attitude_and_rate_are_found(followed):
    truth, _, found = followed
    estimated = np.array([directions_body(found, np.tile(axis, (150, 1))) for axis in np.eye(3)])
    error = [Rotation.from_matrix(estimated[:, n].T @ truth.dcm[n].T).magnitude() for n in range(100, 150)]
    assert np.degrees(np.sqrt(np.mean(np.square(error)))) < 2.0
    np.testing.assert_allclose(found.rate_degps[100:], np.degrees(truth.omega_radps[100:]), atol=0.15)


def test_the_next_sample_is_predicted_to_its_noise(followed):
    _, _, found = followed
    assert np.sqrt(np.mean(found.direction_deg[60:] ** 2)) < 1.5 * noise_deg(followed[0])
    assert np.sqrt(np.mean(found.strength_nt[60:] ** 2)) < 1.5 * 150.0
    assert len(found.rows) == 150
    assert all(one.taken for one in found.ticks)


def test_what_it_predicts_without_samples_stays_near(followed):
    _, around, found = followed
    errors = dict(without_sample(around, KNOWN, found.ticks[80], found.config))
    assert sorted(errors) == list(range(1, 70))
    assert max(errors.values()) < 6.0


def test_with_another_inertia_it_does_not(followed):
    """A wobble of 3 deg/s under a tensor without one: what the tests above rest on."""
    truth, around, _ = followed
    sphere = KNOWN._replace(inertia=np.diag((1.0, 0.93, 0.31)))
    found = follow(around, sphere, started(truth), filter_config(sphere.inertia, 1.0, NOISE))
    assert np.sqrt(np.mean(found.direction_deg[60:] ** 2)) > 2.0 * noise_deg(truth)


def test_a_wild_sample_is_refused_and_a_row_without_one_is_passed(tmp_path):
    truth = made_up(90)
    head, *rows = truth.text.splitlines()
    fields = rows[70].split(",")
    rows[70] = ",".join([fields[0], "250000", *fields[2:]])
    fields = rows[72].split(",")
    rows[72] = ",".join([fields[0], "", *fields[2:]])
    path = tmp_path / "wild.csv"
    path.write_text("\n".join([head, *rows]) + "\n")
    recorded = read_pass(path)
    around = along(recorded, nearest_elements_of(recorded))
    found = follow(around, KNOWN, started(truth), filter_config(KNOWN.inertia, 1.0, NOISE))
    assert [one.row for one in found.ticks if not one.taken] == [70]
    assert 72 not in found.rows
    assert found.direction_deg[-1] < 4.0


def nearest_elements_of(recorded):
    return nearest_elements(TLE, recorded.middle_unix_s)


def test_a_gap_that_is_too_long_is_refused(tmp_path):
    head, *rows = made_up(30).text.splitlines()
    late = [",".join([str(float(row.split(",")[0]) + 700.0), *row.split(",")[1:]]) for row in rows[15:]]
    path = tmp_path / "gap.csv"
    path.write_text("\n".join([head, *rows[:15], *late]) + "\n")
    recorded = read_pass(path)
    around = along(recorded, nearest_elements_of(recorded))
    with pytest.raises(
        HarnessError,
        match=rf"after utc_unix_s = {recorded.utc_unix_s[14]:.15g} there is no field sample for 701 s",
    ):
        follow(around, KNOWN, started(made_up(30)), filter_config(KNOWN.inertia, 1.0, NOISE))
