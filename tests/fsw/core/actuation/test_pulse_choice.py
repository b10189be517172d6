"""Which pulse the scheduler takes: of all candidates the one that leaves least of the impulse wanted."""

from collections import Counter
from dataclasses import replace
from itertools import product
from math import inf, nan

import numpy as np
import pytest

from fsw.core.actuation import pulses
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.laws.plan.pulse_model import Pulse

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
TICK = 10_000
DIAGONAL_T = (3e-5, 3e-5, 3e-5)


def make_config(levels_am2=(0.5, 2.0, 8.0), inertia_inverse=IDENTITY, shared=True):
    inverse = np.array(inertia_inverse)
    return PulseConfig(
        pulse_ticks=3,
        backoff_ticks=100,
        duration_ms=3000,
        shared=shared,
        levels_am2=levels_am2,
        pulse_s=3.0,
        tick_s=1.0,
        leak_s=300.0,
        rate_metric=tuple(map(tuple, (inverse @ inverse).tolist())),
        energy_metric=inertia_inverse,
    )


def timers(config, ready_tick=(0, 0, 0), busy_until=0):
    """A state whose timers, unless told otherwise, ran out long ago; what it owes must not count here."""
    return replace(
        pulses.boot(0, config),
        ready_tick=ready_tick,
        busy_until=busy_until,
        pending_impulse_body_nms=(1.0, -2.0, 3.0),
    )


def choose(config, wanted, b_body_t, **state):
    """The choice by the rate that is left."""
    return pulses.choose(timers(config, **state), wanted, config.rate_metric, TICK, b_body_t, config)


def impulse(config, coil, level, b_body_t):
    """T m x b of a pulse, by numpy."""
    dipole_am2 = np.sign(level) * config.levels_am2[abs(level) - 1] * np.array(config.coil_axes[coil])
    return config.pulse_s * np.cross(dipole_am2, b_body_t)


def rate_left(config, wanted, b_body_t, pulse):
    """|J^-1 (r - T m x b)|^2, by numpy."""
    rest = np.array(wanted) - (0.0 if pulse is None else impulse(config, pulse.coil, pulse.level, b_body_t))
    return float(np.sum((np.array(config.energy_metric) @ rest) ** 2))


def energy_left(config, wanted, b_body_t, pulse):
    """(r - T m x b)^T J^-1 (r - T m x b), twice the energy of the rate that is left, by numpy."""
    rest = np.array(wanted) - (0.0 if pulse is None else impulse(config, pulse.coil, pulse.level, b_body_t))
    return float(rest @ np.linalg.solve(np.linalg.inv(config.energy_metric), rest))


def random_case(rng):
    """Inertia with products of inertia, levels, field, and an impulse of the size that one pulse gives."""
    rotation, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    inertia_kgm2 = rotation @ np.diag(rng.uniform(0.5, 5.0, 3)) @ rotation.T
    inverse = tuple(map(tuple, np.linalg.inv(inertia_kgm2).tolist()))
    levels = tuple(np.cumprod(rng.uniform(1.2, 4.0, 3)).tolist())
    config = make_config(levels_am2=levels, inertia_inverse=inverse)
    b_body_t = tuple((rng.normal(size=3) * 3e-5).tolist())
    size = 3.0 * 3e-5 * levels[int(rng.integers(3))]
    return config, tuple((rng.normal(size=3) * size).tolist()), b_body_t


METRICS = {"rate_metric": rate_left, "energy_metric": energy_left}


@pytest.mark.long
@pytest.mark.parametrize("metric", METRICS)
def test_of_all_nineteen_candidates_the_one_that_leaves_least_is_taken(metric):
    left_over = METRICS[metric]
    rng = np.random.default_rng(7)
    taken = Counter()
    for _ in range(1500):
        config, owed, b_body_t = random_case(rng)
        free = [bool(rng.integers(4)) for _ in range(3)]
        ready_tick = tuple(TICK if is_free else TICK + 1 for is_free in free)
        candidates = [None] + [
            Pulse(coil, level) for coil in range(3) if free[coil] for level in (-3, -2, -1, 1, 2, 3)
        ]
        weights = getattr(config, metric)
        chosen = pulses.choose(timers(config, ready_tick), owed, weights, TICK, b_body_t, config)
        assert chosen in candidates
        least = min(left_over(config, owed, b_body_t, candidate) for candidate in candidates)
        assert left_over(config, owed, b_body_t, chosen) <= least * (1.0 + 1e-9)
        taken[chosen] += 1
    assert len(taken) == 19, "each candidate was the best at some time"


@pytest.mark.parametrize("metric", METRICS)
def test_of_coils_out_of_square_it_is_the_one_whose_true_dipole_leaves_least(metric):
    """So far out of square that by the nominal axes it would often be another."""
    rng = np.random.default_rng(23)
    others = 0
    for _ in range(30):
        nominal, wanted, b_body_t = random_case(rng)
        axes = np.eye(3) + rng.uniform(-0.4, 0.4, (3, 3))
        config = replace(nominal, coil_axes=tuple(map(tuple, axes.tolist())))
        candidates = [None, *(Pulse(*one) for one in product(range(3), (-3, -2, -1, 1, 2, 3)))]
        left = [METRICS[metric](config, wanted, b_body_t, candidate) for candidate in candidates]
        asked = (wanted, getattr(config, metric), TICK, b_body_t)
        chosen = pulses.choose(timers(config), *asked, config)
        assert chosen == candidates[int(np.argmin(left))]
        others += chosen != pulses.choose(timers(nominal), *asked, nominal)
    assert others > 5


def test_a_coil_out_of_square_pays_by_its_true_dipole():
    axes, b_body_t = ((0.98, 0.05, -0.02), (0.01, 1.03, 0.04), (-0.03, 0.02, 0.97)), (2e-5, -3e-5, 1e-5)
    config = replace(make_config(), coil_axes=axes)
    for coil, level in product(range(3), (-3, 2)):
        found = pulses.impulse(Pulse(coil, level), b_body_t, config)
        assert found == pytest.approx(impulse(config, coil, level, b_body_t), rel=1e-12)


def test_the_two_metrics_are_two():
    """Else the one could stand in for the other above."""
    rng = np.random.default_rng(11)
    differ = 0
    for _ in range(300):
        config, wanted, b_body_t = random_case(rng)
        chosen = {
            pulses.choose(timers(config), wanted, getattr(config, metric), TICK, b_body_t, config)
            for metric in METRICS
        }
        differ += len(chosen) == 2
    assert differ > 10


def test_the_inertia_weighs_what_is_left():
    """A torque about the light axis counts more: the same impulse is met by another coil."""
    owed, b_body_t = (3e-5, 0.0, 3.3e-5), (0.0, 3e-5, 0.0)
    even, uneven = (
        make_config(),
        make_config(inertia_inverse=((9.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
    )
    assert choose(even, owed, b_body_t).coil == 0
    assert choose(uneven, owed, b_body_t).coil == 2


BINARY = {"levels_am2": (1.0, 2.0, 4.0)}
"""With a field of 1 T along axis 3 everything is a small multiple of 1/2: ties are ties to the last bit."""

UNIT_T = (0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("owed", "expected"),
    [
        ((0.0, 0.0, 0.0), None),
        ((0.0, -1.5, 0.0), None),  # as far from level 1 as from nothing
        ((0.0, -1.5000001, 0.0), Pulse(0, 1)),
        ((0.0, 1.5, 0.0), None),
        ((0.0, 1.5000001, 0.0), Pulse(0, -1)),
        ((0.0, -4.5, 0.0), Pulse(0, 1)),  # as far from level 1 as from level 2: the smaller
        ((0.0, -4.5000001, 0.0), Pulse(0, 2)),
        ((6.0, -6.0, 0.0), Pulse(0, 2)),  # as far by coil 1: the first
        ((1e-5, 1e-5, 100.0), None),  # along the field there is nothing to be done
    ],
)
def test_ties_go_to_nothing_then_to_the_smaller_level_then_to_the_first_coil(owed, expected):
    config = make_config(**BINARY)
    assert choose(config, owed, UNIT_T) == expected


@pytest.mark.parametrize("coil", [0, 1, 2])
def test_a_coil_along_the_field_is_never_taken(coil):
    config = make_config()
    b_body_t = tuple(4e-5 if axis == coil else 0.0 for axis in range(3))
    rng = np.random.default_rng(coil)
    taken = set()
    for owed in rng.normal(size=(200, 3)) * 1e-4:
        pulse = choose(config, tuple(owed.tolist()), b_body_t)
        taken.add(None if pulse is None else pulse.coil)
    assert taken - {None} == {0, 1, 2} - {coil}


@pytest.mark.parametrize(
    ("owed", "b_body_t"),
    [
        ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
        ((1.0, 1.0, 1.0), (nan, 0.0, 0.0)),
        ((nan, 1.0, 1.0), DIAGONAL_T),
        ((nan, nan, nan), DIAGONAL_T),
        ((1.0, 1.0, 1.0), (inf, inf, inf)),
    ],
)
def test_without_a_field_or_with_no_numbers_nothing_is_fired(owed, b_body_t):
    config = make_config()
    assert choose(config, owed, b_body_t) is None


def test_a_pulse_of_a_locked_coil_is_left_to_wait_and_the_best_of_the_others_taken():
    """Not the best of all, and not nothing."""
    config = make_config(shared=False)
    wanted = tuple(impulse(config, 0, 3, DIAGONAL_T))
    assert choose(config, wanted, DIAGONAL_T) == Pulse(0, 3)
    locked = (TICK + 1, 0, 0)
    assert choose(config, wanted, DIAGONAL_T, ready_tick=locked).coil in {1, 2}
    assert choose(config, wanted, DIAGONAL_T, ready_tick=locked, busy_until=TICK + 1) is None
