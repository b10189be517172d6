"""A driven wheel in the flight loop: real frames of plant and boards, and what is lost or forged of them."""

from dataclasses import replace

import numpy as np
import pytest
from flight_states import altered

from fsw.core.fdir import fdir
from fsw.core.restart import begin_count
from fsw.core.state_bytes import checksum
from fsw.wire.messages import Mode, WheelStatus, WheelTorque

WHEEL = {
    "axis": [0.1, -0.2, 1.0],
    "inertia_kgm2": 2e-4,
    "max_torque_nm": 2e-3,
    "max_momentum_nms": 0.12,
    "viscous_nms": 2e-7,
    "coulomb_nm": 2e-5,
    "momentum_nms": 0.02,
}
COILS = {"driver": "continuous", "max_dipole_am2": 10.0}
INCLINED = {"altitude_km": 500.0, "inclination_deg": 51.6, "raan_deg": 60.0, "u0_deg": 20.0}


@pytest.fixture
def world(make_world):
    def make(**settings):
        sections = {"wheel": WHEEL, "coils": COILS, "orbit": INCLINED, "control": {"law": "wheel_allocation"}}
        return make_world(**(sections | settings))

    return make


@pytest.fixture
def acting(world):
    """A world some ticks into ACQUIRE."""
    made = world()
    while made.state.modes.mode is not Mode.ACQUIRE:
        made.step()
        assert made.state.tick < 300
    made.fly(20)
    return made


def torques(messages):
    return [message for message in messages if isinstance(message, WheelTorque)]


def test_in_the_loop_the_wheel_is_asked_for_a_torque_once_a_tick_and_gives_it(acting):
    asked = [torques(messages) for messages in acting.fly(30)]
    assert {len(messages) for messages in asked} == {1}
    values = [message.torque for (message,) in asked]
    assert np.abs(values).max() > 1e-5
    assert [message.tick for (message,) in asked] == [(acting.state.tick - 29 + k) & 0xFF for k in range(30)]
    assert acting.state.wheel.refused == 0


def test_the_controller_knows_the_momentum_and_the_filter_stays_honest(acting):
    for _ in range(200):
        acting.step()
    truth = acting.plant.truth()
    assert 2e-4 * acting.state.wheel.speed_radps == pytest.approx(truth.wheel_nms, abs=2e-3)
    rate = np.subtract(acting.state.attitude.omega_body_orbit_radps, truth.omega_body_orbit_radps)
    assert np.abs(rate).max() < acting.state.attitude.sigma3_rate_radps
    assert acting.state.attitude.sigma3_rate_radps < 2e-3


@pytest.mark.interpreted
def test_the_coils_are_judged_with_the_momentum_of_the_tick(acting, monkeypatch):
    judged = []
    monkeypatch.setattr(fdir.torques, "judge_effect", lambda *words: judged.append(words[-1]))
    before = acting.state.wheel.speed_radps
    acting.step()
    mean_nms = 0.5 * WHEEL["inertia_kgm2"] * (before + acting.state.wheel.speed_radps)
    axis = np.array(WHEEL["axis"]) / np.linalg.norm(WHEEL["axis"])
    (wheel_nms,) = judged
    np.testing.assert_allclose(wheel_nms, mean_nms * axis, rtol=1e-3)


def test_without_one_nothing_is_asked_of_it_and_the_state_has_no_place_for_it(make_world):
    world = make_world(coils=COILS)
    assert not any(torques(messages) for messages in world.fly(60))
    assert world.state.wheel is None


def test_a_wheel_whose_reports_are_lost_is_not_driven(acting, without):
    lost = without(WheelStatus)
    stale = acting.config.wheel.stale_ticks
    asked = [len(torques(acting.step(lost))) for _ in range(stale + 20)]
    assert asked == [1] * stale + [0] * 20
    again = [len(torques(messages)) for messages in acting.fly(3)]
    assert again == [1, 1, 1]


def test_a_report_that_cannot_be_changes_nothing_but_the_count(acting):
    def forged(inbox):
        jumped = WheelStatus(1, 1, 590.0, 0.0, counter=acting.state.tick + 1)
        frames = tuple(frame for frame in inbox.frames if frame.can_id != WheelStatus.ID)
        return inbox.replace(frames=(*frames, jumped.encode()))

    before = acting.state.wheel
    acting.step(forged)
    after = acting.state.wheel
    assert (after.refused, after.speed_radps, after.change_nms) == (1, before.speed_radps, 0.0)


def test_in_safe_it_coasts(acting, without):
    world = acting
    while world.state.modes.mode is not Mode.SAFE:
        world.state = altered(world.state, modes=replace(world.state.modes, mode=Mode.SAFE, held=True))
    assert not any(torques(messages) for messages in world.fly(5))
    assert world.state.wheel.requested_nm == 0.0


def test_its_view_counts_in_the_checksum(acting):
    state = acting.state
    for field, value in (
        ("speed_radps", 1.0),
        ("tick", 5),
        ("refused", 9),
        ("requested_nm", 1e-9),
        ("change_nms", 1e-9),
    ):
        assert checksum(altered(state, wheel=replace(state.wheel, **{field: value}))) != checksum(state)


def test_after_a_restart_of_the_plant_its_momentum_is_not_known(acting):
    state = altered(acting.state, wheel=replace(acting.state.wheel, refused=3))
    begin_count(state, 5, acting.config)
    assert (state.wheel.tick, state.wheel.has_speed, state.wheel.refused) == (-1, False, 3)
