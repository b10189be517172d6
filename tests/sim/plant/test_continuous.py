"""The plant with the continuous driver: three coils at once, for a part of a tick, off for samples."""

import numpy as np
import pytest

from fsw.wire.messages import (
    CLASSES,
    CoilDipole,
    CoilDipoleStatus,
    CoilFire,
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    MagField,
    intact,
)
from sim.plant.config import CoilConfig, ContinuousConfig
from sim.plant.sensor_config import MagnetometerConfig

SCALE = (0.97, 1.02, -1.05)
COILS = CoilConfig((0.5, 2.0, 8.0), 11.0, 0.01, SCALE, ContinuousConfig(12.0, 0.8))
ASKED = np.array([0.25, -0.5, 0.125])
COUPLING = ((2e-6, 0.0, 0.0), (0.0, 2e-6, 0.0), (0.0, 0.0, 2e-6))


@pytest.fixture
def fly(make_plant):
    """Messages and truth by tick; ``asked`` gives the fractions of a tick, or None."""

    def fly(ticks, asked, **parts):
        plant, history = make_plant(**{"coils": COILS} | parts), []
        for tick in range(ticks):
            frames = plant.begin_tick()
            assert all(map(intact, frames))
            history.append(([CLASSES[f.can_id].decode(f.data) for f in frames], plant.truth()))
            if (m := asked(tick)) is not None:
                plant.receive(CoilDipole(*m, counter=tick).encode())
            plant.end_tick()
        return history

    return fly


def of(kind, said):
    return [message for message in said if isinstance(message, kind)]


@pytest.mark.parametrize("max_substep_s", [1.0, 0.3, 0.07])
def test_the_mean_dipole_is_the_fraction_of_full_scale_over_the_fraction_of_the_tick(fly, max_substep_s):
    history = fly(12, lambda tick: ASKED if tick in {3, 4, 7} else None, max_substep_s=max_substep_s)
    full = 12.0 * 0.8 * ASKED * SCALE
    for tick, (_, truth) in enumerate(history):
        assert truth.m_body_am2 == pytest.approx(
            full if tick in {4, 5, 8} else np.zeros(3), rel=1e-8, abs=1e-7
        )
    assert history[2][1].m_body_am2 == history[3][1].m_body_am2 == (0.0, 0.0, 0.0)


def test_the_board_tells_what_flowed(fly):
    rng = np.random.default_rng(4)
    asked = rng.integers(-(2**16), 2**16, (40, 3)) / 2.0**16
    history = fly(41, lambda tick: asked[tick] if tick < 40 else None)
    for said, truth in history[1:]:
        (told,) = of(CoilDipoleStatus, said)
        assert truth.m_body_am2 == pytest.approx(
            9.6 * np.array(told.values()[:3]) * SCALE, rel=1e-8, abs=1e-7
        )
    assert [of(CoilDipoleStatus, said)[0].values()[:3] for said, _ in history[1:]] == [
        tuple(m) for m in asked
    ]


def test_the_torque_of_a_tick_is_that_dipole_s(fly, make_config):
    """Change of rate against a flight that is not driven: J^-1 (m x b) h, but for the turn in a tick."""
    driven, still = fly(6, lambda tick: ASKED if tick == 4 else None), fly(6, lambda tick: None)
    change = np.subtract(driven[5][1].omega_body_orbit_radps, still[5][1].omega_body_orbit_radps)
    truth = driven[5][1]
    torque = np.cross(truth.m_body_am2, truth.b_body_t)
    expected = np.linalg.solve(np.array(make_config().body.inertia_kgm2), torque)
    assert change == pytest.approx(expected, rel=5e-3, abs=5e-3 * np.linalg.norm(expected))
    assert truth.torque_body_nm[1] == pytest.approx(torque)


def test_coils_are_off_and_without_current_when_the_sensors_sample(fly):
    sensor = MagnetometerConfig(coil_coupling_t_per_am2=COUPLING)
    history = fly(30, lambda tick: ASKED * (-1) ** tick, magnetometer=sensor)
    for tick, (said, truth) in enumerate(history):
        (status,), (field,) = of(CoilStatus, said), of(MagField, said)
        assert status == CoilStatus(0, tick % 3, 0, 0, 0, 0, counter=status.counter)
        read_nt = np.array([field.b_x, field.b_y, field.b_z])
        assert read_nt == pytest.approx(1e9 * np.array(truth.b_body_t), abs=1.01)


def test_driven_to_the_end_of_a_tick_they_are_felt_and_read_back(fly):
    to_the_end = CoilConfig((0.5, 2.0, 8.0), 11.0, 0.01, SCALE, ContinuousConfig(12.0, 1.0))
    sensor = MagnetometerConfig(coil_coupling_t_per_am2=COUPLING)
    history = fly(6, lambda tick: ASKED, magnetometer=sensor, coils=to_the_end)
    said, truth = history[4]
    own_nt = np.array(of(MagField, said)[0].values()[1:4]) - 1e9 * np.array(truth.b_body_t)
    assert own_nt == pytest.approx(2000.0 * 12.0 * ASKED * SCALE, abs=1.1)
    assert of(CoilStatus, said)[0].current_ma == round(1e3 * 12.0 * ASKED.sum() / 11.0)


@pytest.mark.parametrize("tick_hz", [1, 2, 5])
def test_the_impulse_does_not_depend_on_the_tick_rate(fly, tick_hz):
    history = fly(10 * tick_hz, lambda tick: ASKED if tick < 5 * tick_hz else None, tick_hz=tick_hz)
    impulse = np.sum([truth.m_body_am2 for _, truth in history], axis=0) / tick_hz
    assert impulse == pytest.approx(5.0 * 12.0 * 0.8 * ASKED * SCALE)


def test_a_pulse_is_refused_and_nothing_flows(make_plant):
    plant = make_plant(coils=COILS)
    reasons = []
    for tick in range(12):
        reasons += of(CoilRefused, [CLASSES[f.can_id].decode(f.data) for f in plant.begin_tick()])
        plant.receive(CoilFire(3, 1, tick, tick & 0xFF, 3000).encode())
        plant.end_tick()
        assert plant.truth().m_body_am2 == (0.0, 0.0, 0.0)
    assert [m.reason for m in reasons] == [CoilRefusedReason.WRONG_BOARD] * 11


def test_a_dipole_moves_nothing_where_the_driver_is_pulsed(make_plant):
    asked, alone = make_plant(backoff_ms=0), make_plant(backoff_ms=0)
    for tick in range(20):
        assert asked.begin_tick() == alone.begin_tick()
        asked.receive(CoilDipole(*ASKED, counter=tick).encode())
        asked.end_tick()
        alone.end_tick()
        assert asked.truth() == alone.truth()


def test_only_the_continuous_board_says_what_dipole_it_drove(fly, make_plant):
    assert all(len(of(CoilDipoleStatus, said)) == 1 for said, _ in fly(5, lambda tick: None))
    assert not any(f.can_id == CoilDipoleStatus.ID for f in make_plant().begin_tick())


def test_same_requests_same_frames_and_truth_to_the_last_bit(fly):
    def run():
        return fly(60, lambda tick: ASKED if tick % 3 else None)

    assert run() == run()
