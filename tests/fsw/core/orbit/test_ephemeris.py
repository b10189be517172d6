from itertools import pairwise
from math import dist, hypot

import numpy as np
import pytest

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import cross, dot, norm, scale, unit
from fsw.core.orbit.ephemeris import advance, earlier, ephemeris_model, node, reference_at
from fsw.core.orbit.field import FieldKind, field_eci_t
from fsw.core.orbit.propagation import circular_orbit, sgp4_orbit, state_eci
from fsw.core.orbit.sun import lit, sun_eci

ORBIT_S = 6041


@pytest.fixture(params=[1, 4, 10])
def tick_hz(request):
    return request.param


@pytest.fixture
def make_model(itamsat, itamsat_epoch_unix_s):
    def make(tick_hz=1, **options):
        return ephemeris_model(itamsat, itamsat_epoch_unix_s, tick_hz, **options)

    return make


def run(model, ticks):
    """Each tick with its window, stepping from the first."""
    window = None
    for tick in ticks:
        window = advance(window, tick, model)
        yield tick, window


# The window


def test_stepping_and_jumping_reach_the_same_window(make_model, tick_hz):
    model = make_model(tick_hz)
    last = 5 * model.node_ticks + 3
    for tick, window in run(model, range(last)):
        if tick % 7 == 0 or tick % model.node_ticks == 0:
            assert window == advance(None, tick, model)


def test_a_window_reached_backwards_or_over_a_gap_is_the_same(make_model, tick_hz):
    model = make_model(tick_hz)
    window = advance(None, 50 * model.node_ticks, model)
    for jump in (49, 51, 52, 200, 0, 1):
        tick = jump * model.node_ticks + 5
        window = advance(window, tick, model)
        assert window == advance(None, tick, model)


def test_the_second_and_third_node_stand_around_the_tick(make_model, tick_hz):
    model = make_model(tick_hz)
    for tick, window in run(model, range(3 * model.node_ticks)):
        second = (window.first_node + 1) * model.node_ticks
        assert second <= tick < second + model.node_ticks


def test_within_a_node_interval_nothing_is_computed(make_model, tick_hz):
    model = make_model(tick_hz)
    start = 4 * model.node_ticks
    window = advance(None, start, model)
    for tick in range(start, start + model.node_ticks):
        assert advance(window, tick, model) is window
    assert advance(window, start + model.node_ticks, model) is not window


def test_one_new_node_a_step_the_other_three_are_kept(make_model, tick_hz):
    model = make_model(tick_hz)
    windows = [w for _, w in run(model, range(0, 10 * model.node_ticks, model.node_ticks))]
    for old, new in pairwise(windows):
        assert new.first_node == old.first_node + 1
        assert all(kept is was for kept, was in zip(new.nodes, old.nodes[1:], strict=False))


def test_nodes_stand_at_the_same_moments_at_every_tick_rate(make_model):
    slow, fast = make_model(1), make_model(10)
    assert advance(None, 437, slow) == advance(None, 4370, fast)
    assert reference_at(advance(None, 437, slow), 437, slow) == reference_at(
        advance(None, 4370, fast), 4370, fast
    )


def test_a_node_is_the_models_own_at_its_moment(make_model, itamsat, itamsat_epoch_unix_s):
    model = make_model(4, node_s=15)
    unix_s = itamsat_epoch_unix_s + 7 * 15
    made = node(7, model)
    assert (made.r_eci_m, made.v_eci_mps) == state_eci(itamsat, unix_s)
    assert made.b_eci_t == field_eci_t(model.field, made.r_eci_m, unix_s)
    assert made.sun_eci == sun_eci(unix_s)


def test_every_number_of_the_window_counts_in_the_checksum(make_model, blind_places):
    assert blind_places(advance(None, 333, make_model())) == []


# The loss of the orbit


def test_an_orbit_that_decays_in_flight_leaves_no_reference_and_raises_nothing(
    decaying, itamsat_epoch_unix_s
):
    model = ephemeris_model(sgp4_orbit(*decaying), itamsat_epoch_unix_s, tick_hz=1)
    alive = advance(None, 0, model)
    late = 30 * 86400
    assert alive is not None
    assert advance(alive, late, model) is None
    assert advance(None, late, model) is None
    assert advance(None, 0, model) == alive


def test_stepping_into_the_loss_ends_where_a_jump_does(decaying, itamsat_epoch_unix_s):
    model = ephemeris_model(sgp4_orbit(*decaying), itamsat_epoch_unix_s, tick_hz=1)
    alive, lost = 0, 30 * 86400 // 20
    while lost - alive > 1:
        middle = (alive + lost) // 2
        alive, lost = (middle, lost) if advance(None, 20 * middle, model) else (alive, middle)
    assert advance(advance(None, 20 * alive, model), 20 * lost, model) is None


def test_a_flight_that_begins_after_the_decay_is_refused(decaying, itamsat_epoch_unix_s):
    with pytest.raises(ValueError, match="too old or decayed"):
        ephemeris_model(sgp4_orbit(*decaying), itamsat_epoch_unix_s + 30 * 86400, tick_hz=1)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"tick_hz": 0}, "at least 1 Hz"),
        ({"tick_hz": 1, "node_s": 9}, "10 to 30 s"),
        ({"tick_hz": 1, "node_s": 31}, "10 to 30 s"),
        ({"tick_hz": 1, "degree": 11}, "degrees 1 to 10"),
    ],
)
def test_a_model_out_of_range_is_refused(make_model, options, reason):
    with pytest.raises(ValueError, match=reason):
        make_model(**options)


def test_a_flight_outside_the_years_of_the_field_is_refused(itamsat):
    with pytest.raises(ValueError, match="2015 to 2030"):
        ephemeris_model(itamsat, 1_400_000_000, tick_hz=1)


# The reference


@pytest.mark.long
@pytest.mark.parametrize(("node_s", "field_error_t"), [(10, 0.005e-9), (20, 0.03e-9), (30, 0.1e-9)])
def test_the_cubic_holds_the_field_to_a_tenth_of_a_nanotesla(
    make_model, itamsat, itamsat_epoch_unix_s, node_s, field_error_t
):
    model = make_model(node_s=node_s)
    for tick, window in run(model, range(0, 4 * ORBIT_S, 7)):
        unix_s = itamsat_epoch_unix_s + tick
        reference = reference_at(window, tick, model)
        r_m, v_mps = state_eci(itamsat, unix_s)
        assert dist(reference.b_eci_t, field_eci_t(model.field, r_m, unix_s)) < field_error_t
        assert dist(reference.r_eci_m, r_m) < 0.3
        assert dist(reference.sun_eci, sun_eci(unix_s)) < 1e-12
        assert reference.radius_m == norm(reference.r_eci_m)
        assert reference.orbit_rate_radps == pytest.approx(norm(cross(r_m, v_mps)) / dot(r_m, r_m), rel=1e-8)


def test_a_lower_orbit_is_held_with_the_default_nodes():
    epoch_s = 1_760_000_000
    orbit = circular_orbit(300.0, 97.6, 20.0, 10.0, epoch_s)
    model = ephemeris_model(orbit, epoch_s, tick_hz=1)
    for tick, window in run(model, range(0, 4 * 5400, 7)):
        r_m, _ = state_eci(orbit, epoch_s + tick)
        b_t = field_eci_t(model.field, r_m, epoch_s + tick)
        assert dist(reference_at(window, tick, model).b_eci_t, b_t) < 0.1e-9


def test_at_a_node_the_reference_is_the_node(make_model, tick_hz):
    model = make_model(tick_hz)
    window = advance(None, 6 * model.node_ticks, model)
    reference = reference_at(window, 6 * model.node_ticks, model)
    assert reference.r_eci_m == window.nodes[1].r_eci_m
    assert reference.b_eci_t == window.nodes[1].b_eci_t
    assert reference.sun_eci == window.nodes[1].sun_eci


def test_the_rate_of_the_field_is_that_of_successive_ticks(make_model):
    """To some percent, whatever the tick."""
    model = make_model(5)
    window = advance(None, 7250, model)
    before, now = (np.array(reference_at(window, tick, model).b_eci_t) for tick in (7249, 7250))
    rate = np.array(reference_at(window, 7250, model).b_rate_eci_tps)
    assert np.linalg.norm(rate) > 1e-8
    np.testing.assert_allclose(rate, (now - before) * 5, rtol=0.0, atol=0.03 * np.linalg.norm(rate))


def test_orbit_axes_are_radius_ahead_and_normal(make_model, itamsat, itamsat_epoch_unix_s):
    model = make_model()
    for tick, window in run(model, range(0, ORBIT_S, 13)):
        q = reference_at(window, tick, model).q_orbit_from_eci
        r_m, v_mps = state_eci(itamsat, itamsat_epoch_unix_s + tick)
        assert hypot(*q) == pytest.approx(1.0, abs=1e-15)
        assert q[0] >= 0.0
        assert dist(rotate(q, unit(r_m)), (1.0, 0.0, 0.0)) < 1e-7
        assert dist(rotate(q, unit(cross(r_m, v_mps))), (0.0, 0.0, 1.0)) < 1e-7
        assert rotate(q, v_mps)[1] > 0.999 * norm(v_mps)


def test_orbit_axes_turn_at_the_orbit_rate(make_model):
    model = make_model(10)
    tick = 12_345
    window = advance(None, tick, model)
    now, soon = (reference_at(window, tick + i, model) for i in (0, 1))
    fixed = unit((0.3, 0.5, -0.8))
    before, after = rotate(now.q_orbit_from_eci, fixed), rotate(soon.q_orbit_from_eci, fixed)
    turned = scale(-0.1, cross((0.0, 0.0, now.orbit_rate_radps), before))
    assert dist(after, [a + b for a, b in zip(before, turned, strict=True)]) < 1e-7


def test_the_direct_dipole_of_a_circular_orbit_keeps_its_normal_component():
    epoch_s = 1_700_000_000
    orbit = circular_orbit(550.0, 97.6, 33.0, 12.0, epoch_s)
    model = ephemeris_model(orbit, epoch_s, 1, field=FieldKind.DIRECT_DIPOLE)
    normal_t = [
        rotate(reference.q_orbit_from_eci, reference.b_eci_t)[2]
        for tick, window in run(model, range(0, 5740, 11))
        for reference in [reference_at(window, tick, model)]
    ]
    assert min(normal_t) == pytest.approx(7.812e15 / 6928137.0**3 * -0.13225639, abs=1e-12)
    assert max(normal_t) - min(normal_t) < 1e-12


def test_the_eclipse_comes_and_goes_as_the_orbit_says(make_model, itamsat, itamsat_epoch_unix_s):
    model = make_model()
    lights = []
    for tick, window in run(model, range(ORBIT_S)):
        reference = reference_at(window, tick, model)
        unix_s = itamsat_epoch_unix_s + tick
        assert reference.lit == lit(state_eci(itamsat, unix_s)[0], sun_eci(unix_s))
        lights.append(reference.lit)
    assert sum(a != b for a, b in pairwise(lights)) == 2
    assert 0.2 < lights.count(False) / ORBIT_S < 0.4


# Before a tick


@pytest.mark.parametrize("start", [300, 2000, 4400])
def test_where_the_satellite_was_a_minute_ago(make_model, tick_hz, start):
    model = make_model(tick_hz)
    tick = start * tick_hz
    reference = reference_at(advance(None, tick, model), tick, model)
    for elapsed_s in (1, 20, 60):
        past = tick - elapsed_s * tick_hz
        then = reference_at(advance(None, past, model), past, model)
        e1_eci, b_eci_t = earlier(reference, float(elapsed_s))
        assert dist(e1_eci, unit(then.r_eci_m)) < np.radians(0.1)
        assert dist(b_eci_t, then.b_eci_t) < 5e-7
    assert earlier(reference, 0.0) == (scale(1.0 / reference.radius_m, reference.r_eci_m), reference.b_eci_t)
