"""A plant with a driven wheel: its board among the others, its momentum a state, its reaction a torque."""

import numpy as np
import pytest

from fsw.wire.messages import CLASSES, PlantBoot, WheelBoot, WheelStatus, WheelStatusResult, WheelTorque
from sim.plant.wheel_config import WheelConfig

AXIS = (0.48, -0.6, 0.64)
WHEEL = WheelConfig(AXIS, 4e-3, 0.02, 0.9, viscous_nms=1e-5, coulomb_nm=1e-4, momentum_nms=0.3)


def heard(frames, kind):
    return [kind.decode(frame.data) for frame in frames if frame.can_id == kind.ID]


def flown(plant, ticks, asked_nm=None):
    """The frames and truth of each tick, the wheel being asked for a torque in each."""
    rows = []
    for tick in range(ticks):
        frames = plant.begin_tick()
        if asked_nm is not None:
            plant.receive(WheelTorque(asked_nm, tick).encode())
        rows.append((frames, plant.truth()))
        plant.end_tick()
    return rows


def test_its_board_speaks_once_a_tick_before_sync(make_plant):
    rows = flown(make_plant(wheel=WHEEL), 5)
    for frames, truth in rows:
        (status,) = heard(frames, WheelStatus)
        assert status.valid
        assert status.speed * WHEEL.inertia_kgm2 == pytest.approx(truth.wheel_nms, abs=1e-6)
    names = [CLASSES[frame.can_id].__name__ for frame in rows[0][0]]
    assert names[-1] == "Sync"
    assert names.index("CoilStatus") < names.index("WheelBoot") < names.index("WheelStatus")


def test_a_torque_speeds_it_up_and_turns_the_body_the_other_way(make_plant):
    plant = make_plant(wheel=WHEEL)
    driven, coasting = flown(plant, 30, 0.008), flown(make_plant(wheel=WHEEL), 30)
    gained = driven[-1][1].wheel_nms - coasting[-1][1].wheel_nms
    assert gained == pytest.approx(29 * 0.008, rel=0.05)
    source = plant.torque_sources.index("wheel")
    reaction = np.array(driven[-1][1].torque_body_nm[source])
    friction_nm = 1e-5 * driven[-1][1].wheel_nms / 4e-3 + 1e-4
    assert np.dot(reaction, AXIS) == pytest.approx(-(0.008 - friction_nm), rel=0.01)
    assert np.cross(reaction, AXIS) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    last = heard(driven[-1][0], WheelStatus)[0]
    assert (last.torque, last.result) == (pytest.approx(0.008, abs=1e-7), WheelStatusResult.DRIVEN)


def test_whatever_the_flight_software_asks_the_board_guards_the_motor(make_plant):
    rows = flown(make_plant(wheel=WHEEL), 5, asked_nm=0.021)
    coasting = flown(make_plant(wheel=WHEEL), 5)
    assert rows[-1][1] == coasting[-1][1]
    assert heard(rows[-1][0], WheelStatus)[0].result == WheelStatusResult.BAD_TORQUE


def test_its_board_restarts_and_the_wheel_turns_on(make_plant):
    plant = make_plant(wheel=WHEEL)
    before = flown(plant, 5, 0.008)[-1][1].wheel_nms
    plant.restart("wheel")
    frames = plant.begin_tick()
    assert len(heard(frames, WheelBoot)) == 1
    assert plant.truth().wheel_nms > before


def test_momentum_is_conserved_with_everything_else(make_plant):
    """Its change against the stars is the sum of the torques of all sources but the wheel's."""
    plant = make_plant(wheel=WHEEL, tick_hz=10, backoff_ms=0)
    inertia = np.array(plant._config.body.inertia_kgm2)
    wheel = plant.torque_sources.index("wheel")
    momenta, torques = [], []
    for tick in range(60):
        plant.begin_tick()
        plant.receive(WheelTorque(0.012 if tick < 30 else -0.015, tick).encode())
        truth = plant.truth()
        body = inertia @ plant.motion.omega_body_radps + truth.wheel_nms * np.array(AXIS)
        c = np.array(plant._body_from_eci)
        momenta.append(c.T @ body)
        outer = [torque for place, torque in enumerate(truth.torque_body_nm) if place != wheel]
        torques.append(c.T @ np.sum(outer, axis=0))
        plant.end_tick()
    change, expected = momenta[-1] - momenta[0], 0.1 * np.sum(torques[:-1], axis=0)
    assert np.linalg.norm(expected) > 1e-7
    assert change == pytest.approx(expected, abs=0.05 * np.linalg.norm(expected))


def test_without_a_wheel_nothing_of_it_is_there(make_plant):
    plant = make_plant()
    (frames, truth), *_ = flown(plant, 3, 0.008)
    assert truth.wheel_nms is None
    assert "wheel" not in plant.torque_sources
    assert not heard(frames, WheelStatus)
    assert len(truth.torque_body_nm) == len(plant.torque_sources)


def test_the_table_of_the_plant_counts_it(make_plant):
    def crc(**parts):
        return heard(make_plant(**parts).begin_tick(), PlantBoot)[0].table_crc

    assert len({crc(), crc(wheel=WHEEL), crc(wheel=WheelConfig(AXIS, 4e-3, 0.02, 0.8))}) == 3


def test_a_wheel_with_more_inertia_than_the_body_is_refused(make_config):
    with pytest.raises(ValueError, match="not positive definite"):
        make_config(wheel=WheelConfig(AXIS, 1.9, 0.02, 0.9))
