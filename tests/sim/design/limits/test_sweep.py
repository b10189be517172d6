"""What is varied, and that what cannot be is found."""

from sim.design.limits.sweep import (
    BOUND,
    LAWS,
    LINES,
    QUANTITIES,
    Line,
    all_orders,
    better_than_bound,
    error_deg,
    orders_of,
)

BACKOFF = QUANTITIES[0]
FLOWN = {order.key: 0.4 if order.law == BOUND else 0.5 for order in all_orders()}


def base_of(quantity, label):
    return next(one for one in quantity.settings if one.label == label)


def test_what_is_the_same_satellite_is_flown_once():
    backoff, torque = base_of(BACKOFF, "100"), base_of(QUANTITIES[4], "30")
    for line in (Line(law) for law in LAWS):
        assert [one.key for one in orders_of(backoff, line)] == [one.key for one in orders_of(torque, line)]
    assert len(all_orders()) == len(FLOWN)


def test_other_satellites_laws_and_starts_are_others():
    keys = {order.key for line in LINES for order in orders_of(base_of(BACKOFF, "100"), line)}
    keys |= {order.key for order in orders_of(base_of(BACKOFF, "160"), Line("mpc"))}
    assert len(keys) == 2 * (1 + 2 * 2) + 2


def test_of_the_starts_the_median_counts():
    setting, line = base_of(BACKOFF, "100"), Line("mpc")
    first, second = (order.key for order in orders_of(setting, line))
    assert error_deg(setting, line, {first: 0.2, second: 0.6}) == 0.4
    assert error_deg(setting, line, {}) is None


def test_a_law_that_is_better_than_the_bound_is_told_wherever_it_is():
    assert better_than_bound(FLOWN) == []
    one = orders_of(base_of(BACKOFF, "160"), Line("pulse_mpc"))[1]
    assert better_than_bound(FLOWN | {one.key: 0.39}) == ["pulse_mpc, back-off [s] 160"]
