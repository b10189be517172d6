"""What cells and samples to come say of a motion that is known to be right, and of one that is not."""

from dataclasses import replace

import numpy as np
import pytest
from recorded_samples import AXES, FACES, MATRIX, OFFSET_NT, RATIOS, made_up

from sim.commissioning.recorded.calibration import KnownCell, PassCalibration
from sim.commissioning.telemetry.follow import Noise, filter_config, follow
from sim.commissioning.telemetry.held_back import azimuth_cells, coasts_deg, sun_azimuths
from sim.commissioning.telemetry.spin import Spin

CELLS = tuple(KnownCell(name, face / np.linalg.norm(face), scale) for name, (face, scale) in FACES.items())
KNOWN = PassCalibration(OFFSET_NT, MATRIX, CELLS, AXES @ np.diag(RATIOS) @ AXES.T)
AXIS = AXES[:, 1]


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    truth = made_up(160)
    around = truth.along(tmp_path_factory.mktemp("pass"))
    return around, followed_from_truth(truth, around)


def followed_from_truth(truth, around):
    start = Spin(31.0, 0.0, truth.dcm[0], np.radians(31.0) * AXIS, np.zeros(3))
    return follow(around, KNOWN, start, filter_config(KNOWN.inertia, 1.0, Noise(field_nt=200.0)))


def turned(followed, angle_deg):
    """The same, with every attitude turned about the spin axis."""
    half = np.radians(angle_deg) / 2.0
    s = (np.cos(half), *(np.sin(half) * AXIS))

    def off(q):
        p0, p = q[0], np.array(q[1:])
        return (p0 * s[0] - p @ s[1:], *(p0 * np.array(s[1:]) + s[0] * p + np.cross(p, s[1:])))

    ticks = [
        one._replace(estimate=replace(one.estimate, q_body_from_eci=off(one.estimate.q_body_from_eci)))
        for one in followed.ticks
    ]
    return type(followed)(followed.start, followed.config, tuple(ticks))


def test_two_cells_show_the_azimuth_of_the_sun(flight):
    around, followed = flight
    found = sun_azimuths(around, KNOWN, followed, AXIS).within(60, 160)
    assert len(found.rows) >= 8
    assert abs(found.median_deg) < 6.0
    assert found.scatter_deg < 4.0


@pytest.mark.parametrize("off_deg", [40.0, -70.0])
def test_a_wrong_azimuth_shows_with_its_size(flight, off_deg):
    around, followed = flight
    right, wrong = (sun_azimuths(around, KNOWN, one, AXIS) for one in (followed, turned(followed, off_deg)))
    assert abs(wrong.median_deg - right.median_deg) == pytest.approx(abs(off_deg), abs=4.0)


def test_the_azimuth_does_not_depend_on_how_bright_all_cells_are(flight):
    around, followed = flight
    dimmer = KNOWN._replace(cells=tuple(cell._replace(full_scale=0.8 * cell.full_scale) for cell in CELLS))
    first, second = (sun_azimuths(around, known, followed, AXIS) for known in (KNOWN, dimmer))
    common = np.intersect1d(first.rows, second.rows)
    assert len(common) > 10
    assert abs(first.median_deg - second.median_deg) < 3.0


def test_cells_that_look_along_the_axis_or_the_same_way_show_none(flight):
    around, followed = flight
    along = KNOWN._replace(cells=(CELLS[0], CELLS[1]._replace(face_body=AXIS)))
    alike = KNOWN._replace(cells=(CELLS[0], CELLS[1]._replace(face_body=CELLS[0].face_body)))
    for known in (along, alike, KNOWN._replace(cells=CELLS[:1]), KNOWN._replace(cells=())):
        assert azimuth_cells(known, around, AXIS) is None
        found = sun_azimuths(around, known, followed, AXIS)
        assert len(found.rows) == 0
        assert np.isnan(found.median_deg)
        assert found.rms_deg == np.inf


def test_coasting_of_a_right_motion_stays_near_and_has_no_horizon_beyond_the_pass(flight):
    around, followed = flight
    found = coasts_deg(around, KNOWN, followed, 60)
    assert len(found[10]) > len(found[60]) > 0
    assert len(found[120]) == 0
    assert np.sqrt(np.mean(found[60] ** 2)) < 5.0


@pytest.mark.parametrize("apart", [3, 7])
def test_where_no_sample_is_due_at_a_time_the_next_one_shows_the_coasting(tmp_path, apart):
    truth = made_up(160)
    head, *rows = truth.text.splitlines()
    thinned = replace(truth, text="\n".join([head, *rows[::apart]]) + "\n")
    around = thinned.along(tmp_path)
    found = coasts_deg(around, KNOWN, followed_from_truth(truth, around), 60 // apart)
    assert all(len(found[horizon]) for horizon in (10, 30, 60))
    assert not len(found[120])
    assert np.sqrt(np.mean(found[60] ** 2)) < 5.0


def test_coasting_of_another_rate_goes_away(flight):
    around, followed = flight
    faster = [
        one._replace(
            estimate=replace(
                one.estimate,
                omega_body_radps=tuple((1.03 * np.array(one.estimate.omega_body_radps)).tolist()),
            )
        )
        for one in followed.ticks
    ]
    wrong = type(followed)(followed.start, followed.config, tuple(faster))
    right, off = (coasts_deg(around, KNOWN, one, 60)[60] for one in (followed, wrong))
    assert np.sqrt(np.mean(off**2)) > 4.0 * np.sqrt(np.mean(right**2))
