"""What is gathered of a flight does not depend on how it is cut into blocks."""

import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.record.estimates import Estimates
from sim.report.requirements.evidence import EvidenceGatherer
from sim.scenario.schema import load, orbit_period_s

SCENARIO = load("microsat")
ORBIT = orbit_period_s(SCENARIO)
TICKS = round(2.2 * ORBIT)
MODES = (
    (0, Mode.SAFE), (30, Mode.DETUMBLE), (500, Mode.ACQUIRE), (4000, Mode.DETUMBLE), (4600, Mode.ACQUIRE),
    (6000, Mode.POINT), (9000, Mode.SAFE), (9050, Mode.DETUMBLE), (9500, Mode.ACQUIRE),
)  # fmt: skip
SHADOWS = {(2000, 4000): 3.0, (7000, 9000): 7.0}
"""Ticks in the Earth's shadow, and by how many degrees the estimate is wrong there."""


def turned_about_z(angle_rad):
    half = angle_rad / 2.0
    return np.stack((np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)), axis=1)


def histories():
    t_s = np.arange(TICKS, dtype=float)
    angle_rad = np.radians(40.0 * np.exp(-t_s / 3000.0))
    lit, wrong_rad = np.ones(TICKS), np.zeros(TICKS)
    for (begin, end), wrong_deg in SHADOWS.items():
        lit[begin:end], wrong_rad[begin:end] = 0.0, np.radians(wrong_deg)
    mode = np.concatenate(
        [
            np.full(end - begin, int(mode))
            for (begin, mode), end in zip(MODES, [*(at for at, _ in MODES[1:]), TICKS], strict=True)
        ]
    )
    return t_s, turned_about_z(angle_rad), turned_about_z(angle_rad + wrong_rad), lit, mode


def gathered(report_of, size):
    t_s, q, q_estimated, lit, mode = histories()
    gatherer = EvidenceGatherer(SCENARIO, "attitude", TICKS)
    for begin in range(0, TICKS, size):
        rows = slice(begin, min(TICKS, begin + size))
        count = rows.stop - rows.start
        rate = np.zeros((count, 3))
        truth = {"t_s": t_s[rows], "q_body_from_orbit": q[rows], "omega_body_orbit_radps": rate,
                 "lit": lit[rows], "m_body_am2": np.zeros((count, 3))}  # fmt: skip
        estimates = Estimates(
            q_estimated[rows],
            rate,
            rate,
            np.tile(np.eye(6) * 1e-4, (count, 1, 1)),
            np.ones(count, dtype=bool),
            mode[rows],
        )
        gatherer.take(truth, estimates)
    return gatherer.evidence(report_of((), TICKS), {})


@pytest.fixture(scope="module")
def whole(report_of):
    return gathered(report_of, TICKS)


def test_the_course_is_the_error_by_half_orbit_from_the_start(whole):
    t_s, *_ = histories()
    half = round(ORBIT / 2.0)
    error = 40.0 * np.exp(-t_s / 3000.0)
    expected = [np.sqrt(np.mean(error[begin : begin + half] ** 2)) for begin in range(0, TICKS, half)]
    assert whole.course == pytest.approx(expected, rel=1e-9)
    assert len(whole.course) == 5


def test_the_error_of_the_estimate_in_the_shadow_is_by_half_orbit_too(whole):
    assert whole.dark_course == pytest.approx((3.0, 3.0, 7.0, 0.0, 0.0), abs=1e-9)


def test_a_fall_is_what_comes_after_a_better_mode(whole):
    """The first SAFE and DETUMBLE are the way up; SAFE and the DETUMBLE after it are one fall each."""
    expected = [(Mode.DETUMBLE, 4000, 600), (Mode.SAFE, 9000, 50), (Mode.DETUMBLE, 9050, 450)]
    assert [mode for mode, *_ in whole.fell_back] == [mode for mode, *_ in expected]
    found = np.array([span for _, *span in whole.fell_back]) * ORBIT
    assert found == pytest.approx(np.array([span for _, *span in expected]), abs=1e-6)


@pytest.mark.parametrize("size", [1000, 4321])
def test_blocks_of_any_size_give_the_same(report_of, whole, size):
    found = gathered(report_of, size)
    assert found.course == pytest.approx(whole.course, rel=1e-12)
    assert found.fell_back == whole.fell_back
    assert found.dark_course == pytest.approx(whole.dark_course, rel=1e-12)
