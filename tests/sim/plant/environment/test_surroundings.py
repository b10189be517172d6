import numpy as np
import pytest

from sim.plant.config import FieldConfig, OrbitConfig
from sim.plant.environment.field import make_field
from sim.plant.environment.orbit import MU_M3PS2, make_orbit
from sim.plant.environment.sun import illumination, sun_eci_m
from sim.plant.environment.surroundings import Environment


def instants(config, substeps, ticks):
    """Times of the stages of some ticks, and the stages."""
    environment = Environment(config, substeps)
    parts = 2 * substeps
    times = [(tick + part / parts) / config.tick_hz for tick in ticks for part in range(parts + 1)]
    return np.array(times), [stage for tick in ticks for stage in environment.stages(tick)]


@pytest.mark.long
@pytest.mark.parametrize("model", ["igrf14", "direct_dipole"])
def test_interpolation_is_as_good_as_the_models(make_config, model):
    config = make_config(field=FieldConfig(model))
    times, stages = instants(config, 1, range(6100))
    r, _ = make_orbit(config.orbit, config.epoch_unix_s).at(times)
    b = make_field(config.field, config.epoch_unix_s).at(times, r)
    r_norm = np.linalg.norm(r, axis=1)
    assert np.abs(np.array([stage.b_eci_t for stage in stages]) - b).max() < 1e-13  # T: 1e-4 nT
    assert np.abs(np.array([stage.e_eci for stage in stages]) - r / r_norm[:, None]).max() < 1e-12
    assert np.array([stage.gradient_ps2 for stage in stages]) == pytest.approx(
        3.0 * MU_M3PS2 / r_norm**3, rel=1e-11
    )


@pytest.mark.long
def test_samples_are_the_models_in_the_orbital_frame(make_config):
    config = make_config()
    ticks = range(3, 6100, 7)
    environment = Environment(config, 1)
    samples = [environment.sample(tick) for tick in ticks]
    t = np.array(ticks, dtype=float)
    r, v = make_orbit(config.orbit, config.epoch_unix_s).at(t)
    sun = sun_eci_m(config.epoch_unix_s, t)
    assert np.array([s.r_eci_m for s in samples]) == pytest.approx(r, abs=1e-5)
    lit = np.array([s.lit for s in samples])
    assert lit == pytest.approx(illumination(r, sun), abs=1e-6)
    assert lit.min() == 0.0
    assert lit.max() == 1.0
    for sample, r_k, v_k, sun_k in zip(samples, r, v, sun, strict=True):
        frame, h = np.array(sample.orbit_from_eci), np.cross(r_k, v_k)
        assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-14)
        assert np.linalg.det(frame) == pytest.approx(1.0)
        assert frame @ r_k == pytest.approx([np.linalg.norm(r_k), 0.0, 0.0], abs=1e-4)
        assert frame @ h == pytest.approx([0.0, 0.0, np.linalg.norm(h)], abs=1e-9 * np.linalg.norm(h))
        assert frame[1] @ v_k > 0.0
        assert sample.orbit_rate_radps == pytest.approx(np.linalg.norm(h) / (r_k @ r_k), rel=1e-10)
        to_sun = sun_k - r_k
        assert sample.sun_eci == pytest.approx(to_sun / np.linalg.norm(to_sun), abs=1e-12)


def test_rate_of_the_frame_is_the_turn_of_its_axes(make_config):
    """The normal hardly moves: what the rate leaves out is the turn of the orbit's plane."""
    environment = Environment(make_config(), 1)
    for tick in range(100, 6000, 450):
        before, now, after = (environment.sample(tick + k) for k in (-1, 0, 1))
        turn = 0.5 * (np.array(after.orbit_from_eci) - np.array(before.orbit_from_eci))
        e1, e2, _ = np.array(now.orbit_from_eci)
        assert turn[0] @ e2 == pytest.approx(now.orbit_rate_radps, rel=1e-5)
        assert abs(turn[2] @ e1) < 1e-9
        assert 0.0 < abs(turn[2] @ e2) < 5e-7


@pytest.mark.parametrize(("tick_hz", "substeps"), [(1, 1), (1, 3), (4, 1), (7, 2), (50, 1)])
def test_stages_of_successive_ticks_meet(make_config, tick_hz, substeps):
    """The end of a tick is the start of the next to the last bit, over the edges of blocks too."""
    environment = Environment(make_config(tick_hz=tick_hz), substeps)
    ends = {}
    for tick in range(700):
        stages = environment.stages(tick)
        assert len(stages) == 2 * substeps + 1
        assert ends.setdefault(tick, stages[0]) == stages[0]
        assert environment.sample(tick).b_eci_t == stages[0].b_eci_t
        ends[tick + 1] = stages[-1]


@pytest.mark.long
def test_tick_rate_and_substeps_do_not_move_the_surroundings(make_config):
    coarse = Environment(make_config(), 1)
    fine = Environment(make_config(tick_hz=10), 3)
    for tick in range(0, 900, 7):
        here, there = coarse.sample(tick), fine.sample(10 * tick)
        assert there.r_eci_m == pytest.approx(here.r_eci_m, abs=1e-4)
        assert there.b_eci_t == pytest.approx(here.b_eci_t, abs=1e-13)


def test_surroundings_can_be_read_in_any_order(make_config):
    environment = Environment(make_config(), 1)
    forward = {tick: environment.sample(tick) for tick in (0, 10, 2000, 5000)}
    assert {tick: environment.sample(tick) for tick in (5000, 10, 2000, 0)} == forward
    assert environment.stages(10)[0].b_eci_t == forward[10].b_eci_t


def test_circular_orbit_in_the_orbital_frame(make_config):
    config = make_config(orbit=OrbitConfig(None, 550e3, 1.7, 0.4, 0.3))
    rates = [Environment(config, 1).sample(tick).orbit_rate_radps for tick in (0, 333, 2000)]
    assert rates == pytest.approx([np.sqrt(MU_M3PS2 / (6378137.0 + 550e3) ** 3)] * 3, rel=1e-11)
