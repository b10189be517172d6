"""The plant as the bus sees it, and the truth behind it."""

from dataclasses import replace

import numpy as np
import pytest
from plant_flights import decode, fire, fly, only

from fsw.wire import messages
from fsw.wire.messages import (
    CoilRefusedReason,
    CoilStatus,
    MagField,
    RefAttitude,
    RefRate,
    Sync,
)
from sim.plant.config import InitialConfig, OrbitConfig
from sim.plant.rotation import matrix
from sim.plant.sensor_config import MagnetometerConfig, SunSensorConfig

DAY = 86400
CIRCLE = OrbitConfig(None, 800e3, 1.72, 0.6, 0.35)


# --- what is on the bus


def test_frames_come_in_their_order_and_nodes_boot_at_tick_0(make_plant):
    history = fly(make_plant(perfect_knowledge=True), 122)
    names = [[type(message).__name__ for message in said] for said, _ in history]
    usual = ["MagField", "SunVector", "CoilStatus", "RefAttitude", "RefRate", "Sync"]
    assert names[0] == [
        *("MagBoot", "MagField", "SunBoot", "SunVector", "CoilBoot", "CoilStatus"),
        *("PlantBoot", "RefAttitude", "RefRate", "Sync"),
    ]
    for tick in range(1, 122):
        beats = [name for name in names[tick] if name.endswith("Heartbeat")]
        assert [name for name in names[tick] if name not in beats] == usual
        assert bool(beats) == (tick in {60, 120})
    assert {name for name in names[60] if name.endswith("Heartbeat")} == {
        f"{node}Heartbeat" for node in ("Mag", "Sun", "Coil", "Plant")
    }


@pytest.mark.parametrize("tick_hz", [1, 4])
def test_sync_ends_each_tick_and_bears_tick_and_time(make_plant, make_config, tick_hz):
    epoch = make_config().epoch_unix_s
    for tick, (said, truth) in enumerate(fly(make_plant(tick_hz=tick_hz), 30)):
        assert said[-1] == Sync(tick, epoch + tick // tick_hz)
        assert truth.t_s == tick / tick_hz


def test_the_plant_counts_its_own_frames_and_the_slips_of_its_pacer(make_plant):
    plant = make_plant(perfect_knowledge=True)
    plant.slips = 3
    history = fly(plant, 121)
    assert [only(RefRate, said).counter for said, _ in history] == [tick % 16 for tick in range(121)]
    beats = [only(messages.PlantHeartbeat, history[tick][0]) for tick in (60, 120)]
    assert [(beat.counter, beat.tick, beat.slips) for beat in beats] == [(0, 60, 3), (1, 120, 3)]
    assert decode([plant.end()]) == [messages.PlantEnd(121)]


def test_without_perfect_knowledge_the_truth_is_not_on_the_bus(make_plant):
    for said, _ in fly(make_plant(), 5):
        assert not any(isinstance(message, RefAttitude | RefRate) for message in said)


def test_perfect_knowledge_is_the_truth_of_the_tick(make_plant):
    for said, truth in fly(make_plant(perfect_knowledge=True), 40):
        attitude, rate = only(RefAttitude, said), only(RefRate, said)
        assert (attitude.q_x, attitude.q_y, attitude.q_z) == pytest.approx(
            truth.q_body_from_orbit[1:], abs=8e-6
        )
        assert (rate.w_x, rate.w_y, rate.w_z) == pytest.approx(truth.omega_body_orbit_radps, abs=1e-6)
        assert attitude.valid == rate.valid == 1


def test_a_rate_that_the_bus_cannot_hold_is_not_valid(make_plant):
    fast = InitialConfig(omega_body_orbit_radps=(0.0, -0.2, 0.0))
    said, _ = fly(make_plant(perfect_knowledge=True, initial=fast), 1)[0]
    assert only(RefRate, said).valid == 0
    assert only(RefAttitude, said).valid == 1


def test_perfect_sensors_show_the_truth_on_the_bus(make_plant):
    plant = make_plant(magnetometer=MagnetometerConfig(), sun_sensor=SunSensorConfig())
    for said, truth in fly(plant, 20):
        field, sun = only(MagField, said), only(messages.SunVector, said)
        assert (field.b_x, field.b_y, field.b_z) == pytest.approx(1e9 * np.array(truth.b_body_t), abs=1.01)
        assert (sun.s_x, sun.s_y, sun.s_z) == pytest.approx(truth.sun_body, abs=4e-5)
        assert field.valid == sun.valid == 1


@pytest.mark.long
def test_the_light_of_the_earth_turns_the_sun_on_the_bus_and_not_in_the_truth(make_plant):
    """Towards nadir, most where the Sun is high; none at the poles' twilight, and no Sun in eclipse."""
    plain, lit_up = SunSensorConfig(), SunSensorConfig(albedo=0.3)
    turns, valid = {}, {}
    plants = [make_plant(sun_sensor=sensor) for sensor in (plain, lit_up)]
    for tick, ((_, truth), (said, other)) in enumerate(
        zip(*(fly(plant, 6000) for plant in plants), strict=True)
    ):
        assert truth == other
        sun = only(messages.SunVector, said)
        valid.setdefault(truth.lit >= 0.5, set()).add(sun.valid)
        if sun.valid and tick % 60 == 0:
            measured, true = np.array([sun.s_x, sun.s_y, sun.s_z]), np.array(truth.sun_body)
            e1 = np.array(matrix(truth.q_body_from_orbit))[:, 0]
            height = e1 @ true
            turns[height] = np.linalg.norm(np.cross(true, measured))
            if height > 0.05:
                assert np.cross(true, measured) @ np.cross(true, -e1) > 0.0
                expected = true - 0.3 * (6378137.0 / np.linalg.norm(truth.r_eci_m)) ** 2 * height * e1
                assert measured == pytest.approx(expected / np.linalg.norm(expected), abs=1e-4)
    assert valid == {True: {1}, False: {0}}
    assert max(turns.values()) > np.radians(5.0)
    assert max(turn for height, turn in turns.items() if height <= 0.0) < 1e-4


@pytest.mark.long
def test_in_eclipse_the_sun_is_not_valid(make_plant):
    valid = {}
    for said, truth in fly(make_plant(), 6000):
        valid.setdefault(truth.lit >= 0.5, set()).add(only(messages.SunVector, said).valid)
    assert valid == {True: {1}, False: {0}}


# --- same in, same out


def test_same_configuration_same_frames_and_truth_to_the_last_bit(make_plant):
    def run():
        plant, log = make_plant(perfect_knowledge=True), []
        for tick in range(400):
            log.append((plant.begin_tick(), plant.truth()))
            if tick % 9 == 5:
                fire(plant, coil=tick % 3, level=-3, seq=tick)
            plant.end_tick()
        return log

    assert run() == run()


def test_another_seed_has_other_noise_and_the_same_truth(make_plant):
    one, other = fly(make_plant(), 30), fly(make_plant(seed=8), 30)
    assert [truth for _, truth in one] == [truth for _, truth in other]
    assert not any(only(MagField, a) == only(MagField, b) for (a, _), (b, _) in zip(one, other, strict=True))


def test_truth_can_be_left_unread(make_plant):
    read, unread = make_plant(), make_plant()
    fly(read, 50)
    for _ in range(50):
        unread.begin_tick()
        unread.end_tick()
    assert read.truth() == unread.truth()


# --- coils


def test_a_pulse_answered_to_tick_k_flows_over_k_to_k_plus_3(make_plant):
    history = fly(make_plant(), 14, {5: lambda plant: fire(plant, coil=1, level=-2)})
    flowed = [truth.m_body_am2[1] for _, truth in history]
    full = -2.0 * 1.02
    assert flowed[:6] == [0.0] * 6
    assert flowed[6] == pytest.approx(full * 0.99)  # rise of 10 ms
    assert flowed[7:9] == pytest.approx([full] * 2)
    assert flowed[9] == pytest.approx(full * 0.01)  # decay
    assert sum(flowed) == pytest.approx(3.0 * full)
    assert flowed[11:] == [0.0] * 3
    assert all(truth.m_body_am2[0] == truth.m_body_am2[2] == 0.0 for _, truth in history)
    statuses = [only(CoilStatus, said) for said, _ in history]
    assert [status.level for status in statuses] == [0] * 6 + [-2] * 3 + [0] * 5
    assert [status.current_ma for status in statuses] == [0] * 6 + [-182] * 3 + [0] * 5
    assert [status.remaining_ms for status in statuses[6:9]] == [2000, 1000, 0]


def test_the_magnetometer_feels_the_coil_while_its_current_flows(make_plant):
    coupling = MagnetometerConfig(
        coil_coupling_t_per_am2=((0.0, 4e-6, 0.0), (0.0, -6e-6, 0.0), (0.0, 5e-6, 0.0))
    )
    history = fly(make_plant(magnetometer=coupling), 14, {5: lambda plant: fire(plant, coil=1, level=2)})
    for tick, (said, truth) in enumerate(history):
        field = only(MagField, said)
        own_nt = np.array([field.b_x, field.b_y, field.b_z]) - 1e9 * np.array(truth.b_body_t)
        expected = np.array([8160.0, -12240.0, 10200.0]) if tick in {6, 7, 8} else np.zeros(3)
        assert own_nt == pytest.approx(expected, abs=1.1)


def test_a_pulse_may_end_inside_a_tick(make_plant):
    history = fly(
        make_plant(pulse_ms=2300, max_substep_s=0.5),
        14,
        {5: lambda plant: fire(plant, coil=0, level=3, duration_ms=2300)},
    )
    flowed = [truth.m_body_am2[0] for _, truth in history]
    full = 8.0 * 0.97
    assert flowed[7] == pytest.approx(full)
    assert flowed[8] == pytest.approx(full * 0.31)  # 0.3 and the decay, all inside the tick
    assert sum(flowed) == pytest.approx(2.3 * full)
    assert only(CoilStatus, history[8][0]).current_ma == 0


@pytest.mark.parametrize("tick_hz", [1, 3, 7])
def test_the_impulse_of_a_pulse_does_not_depend_on_the_tick_rate(make_plant, tick_hz):
    history = fly(
        make_plant(tick_hz=tick_hz), 14 * tick_hz, {5 * tick_hz: lambda plant: fire(plant, coil=2, level=1)}
    )
    flowed = np.array([truth.m_body_am2[2] for _, truth in history])
    assert flowed.sum() / tick_hz == pytest.approx(3.0 * 0.5 * 1.05)
    assert np.flatnonzero(flowed)[0] == 5 * tick_hz + 1


def test_a_coil_whose_axis_is_turned_drives_the_other_axes_too(make_plant, make_config):
    """Coil 1 turned by 30 mrad about axis 3: it points at -axis 1 by the sine."""
    turned = replace(make_config().coils, misalignment_rad=((0.0,) * 3, (0.0, 0.0, 0.03), (0.0,) * 3))
    history = fly(make_plant(coils=turned), 9, {5: lambda plant: fire(plant, coil=1, level=2)})
    row = history[8][1]
    assert row.m_body_am2 == pytest.approx((-2.04 * np.sin(0.03), 2.04 * np.cos(0.03), 0.0))
    assert row.torque_body_nm[1] == pytest.approx(np.cross(row.m_body_am2, row.b_body_t))


def test_a_satellite_ahead_of_its_orbit_is_ahead_in_the_truth(make_plant):
    there, ahead = (fly(make_plant(orbit=replace(CIRCLE, along_track_m=d)), 2)[1][1] for d in (0.0, 5e3))
    gap = np.subtract(ahead.r_eci_m, there.r_eci_m)
    assert np.linalg.norm(gap) == pytest.approx(5e3, rel=1e-6)
    assert np.linalg.norm(np.subtract(ahead.b_body_t, there.b_body_t)) > 5e-9
    assert ahead.q_body_from_orbit == pytest.approx(there.q_body_from_orbit, abs=1e-6)


def test_a_magnetometer_whose_axes_are_not_orthogonal_errs_on_the_bus(make_plant):
    skewed = MagnetometerConfig(non_orthogonality_rad=(0.02, 0.0, 0.0))
    for said, truth in fly(make_plant(magnetometer=skewed), 20):
        field, b_nt = only(MagField, said), 1e9 * np.array(truth.b_body_t)
        expected = (b_nt[0], np.sin(0.02) * b_nt[0] + np.cos(0.02) * b_nt[1], b_nt[2])
        assert (field.b_x, field.b_y, field.b_z) == pytest.approx(expected, abs=1.01)


def test_what_a_pulse_leaves_turns_the_body_and_is_in_the_residual_dipole_s_torque(make_plant, make_config):
    """J dw/dt = T - w x J w after the pulse, with 5 % of its dipole left."""
    inertia, coils = (
        np.array(make_config().body.inertia_kgm2),
        replace(make_config().coils, remanence_part=0.05),
    )
    plant, rows, omega = make_plant(tick_hz=10, coils=coils, backoff_ms=0), [], []
    for tick in range(60):
        plant.begin_tick()
        rows.append(plant.truth())
        omega.append(plant.motion.omega_body_radps)
        if tick == 5:
            fire(plant, coil=0, level=3)
        plant.end_tick()
    left = np.array([0.05 * 8.0 * 0.97, 0.0, 0.0])
    for k in (3, 20, *range(40, 59)):
        m = np.array([0.01, 0.02, -0.03]) + (left if k >= 40 else 0.0)
        assert rows[k].torque_body_nm[2] == pytest.approx(np.cross(m, rows[k].b_body_t))
        assert bool(any(rows[k].m_body_am2)) == (k == 20)
        w, change = np.array(omega[k]), (np.array(omega[k + 1]) - omega[k - 1]) / 0.2
        torque = np.sum(rows[k].torque_body_nm, axis=0)
        assert inertia @ change + np.cross(w, inertia @ w) == pytest.approx(torque, rel=1e-5, abs=1e-10)


def test_the_magnetometer_feels_what_a_pulse_leaves(make_plant, make_config):
    coupling = MagnetometerConfig(coil_coupling_t_per_am2=((4e-6, 0.0, 0.0), (0.0,) * 3, (0.0,) * 3))
    coils = replace(make_config().coils, remanence_part=0.05, time_constant_s=0.0)
    plant = make_plant(magnetometer=coupling, coils=coils)
    history = fly(plant, 12, {5: lambda plant: fire(plant, coil=0, level=3)})
    own_nt = [only(MagField, said).b_x - 1e9 * truth.b_body_t[0] for said, truth in history]
    assert own_nt[:6] == pytest.approx([0.0] * 6, abs=1.01)
    assert own_nt[9:] == pytest.approx([4e3 * 0.05 * 8.0 * 0.97] * 3, abs=1.01)


def test_a_refused_request_drives_nothing_and_is_reported(make_plant):
    history = fly(make_plant(), 8, {2: lambda plant: fire(plant, seq=77)})
    assert all(truth.m_body_am2 == (0.0, 0.0, 0.0) for _, truth in history)
    refused = [m for said, _ in history for m in said if isinstance(m, messages.CoilRefused)]
    assert [(m.seq, m.reason) for m in refused] == [(77, CoilRefusedReason.LOCKOUT)]
    assert refused[0] in history[3][0]


def test_frames_for_others_move_nothing(make_plant):
    plant, alone = make_plant(), make_plant()
    for _ in range(20):
        assert plant.begin_tick() == alone.begin_tick()
        for message in (messages.NavRate(1, 0.01, 0.02, 0.03), messages.TickDone(plant.tick, 5)):
            plant.receive(message.encode())
        plant.end_tick()
        alone.end_tick()
