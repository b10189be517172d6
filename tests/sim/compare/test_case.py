"""Which laws are compared, and by which driver."""

import pytest

from fsw.core.laws.entry import Aim, Need
from fsw.core.laws.table import LAWS
from fsw.input.schema import TableError
from sim.compare.case import Driver, cases, chosen_laws
from sim.errors import HarnessError
from sim.scenario.schema import load
from sim.tuning.kept import KeptGains

BOTH = (Driver.PULSED, Driver.CONTINUOUS)


def test_every_law_has_an_aim():
    assert all(isinstance(row.aim, Aim) for row in LAWS.values())


def test_laws_of_the_scenarios_own_aim_by_default():
    three_axis = chosen_laws(load("microsat"), None)
    assert {"pd", "lqr", "sliding", "output_feedback"} <= set(three_axis)
    assert not {"bdot", "sun_pointing", "spin_up", "dual_spin"} & set(three_axis)
    damping = chosen_laws(load("tumbling", {"control": {"law": "bdot"}}), None)
    assert {"predictive", "rate_damping", "bdot"} <= set(damping)
    assert "pd" not in damping


def test_with_a_boom_or_a_wheel_laws_of_the_whole_attitude_too():
    boom = chosen_laws(load("posat1"), None)
    assert {"predictive", "rate_damping", "pd", "lqr"} <= set(boom)
    wheel = chosen_laws(load("pitch-wheel"), None)
    assert {"dual_spin", "pd", "field_tracking"} <= set(wheel)
    spinner = chosen_laws(load("spinner"), None)
    assert {"three_term", "spin_up"} <= set(spinner)
    assert "pd" not in spinner


def test_gains_that_are_kept_stand_under_the_settings():
    kept = KeptGains(0, 24, 4.0, rows={"pulsed": {"pd": {"control": {"k_w": 1e6, "k_a": 100.0}}}})
    settings = {"control": {"k_a": 200.0}}
    pd, lqr = cases("microsat", settings, ("pd", "lqr"), (Driver.PULSED,), 1, None, kept)
    assert (pd.tuned, lqr.tuned) == (False, False), "one of its gains is that of the settings"
    control = load("microsat", pd.order.overrides).control
    assert (control.k_w, control.k_a) == (1e6, 200.0)
    assert load("microsat", lqr.order.overrides).control.k_w == load("microsat").control.k_w
    (pd,) = cases("microsat", {"time": {"orbits": 2.0}}, ("pd",), (Driver.PULSED,), 1, None, kept)
    assert pd.tuned


def test_laws_and_aims_by_name_in_the_order_of_the_table():
    scenario = load("microsat")
    assert chosen_laws(scenario, "lqr, pd,pd") == ("pd", "lqr")
    sun = tuple(law for law, entry in LAWS.items() if entry.aim is Aim.SUN)
    assert "sun_pointing" in sun
    assert chosen_laws(scenario, "sun,bdot") == ("bdot", *sun)
    wheels = (Need.MOMENTUM, Need.DRIVEN_WHEEL, Need.PITCH_WHEEL)
    assert chosen_laws(scenario, "all") == tuple(law for law in LAWS if LAWS[law].needs not in wheels)


def test_a_law_of_ones_own_flies_beside_those_that_are_named(tmp_path):
    file = tmp_path / "my_law.py"
    file.write_text(
        "from fsw.own_law import Demand\ndef idle(inputs, memory, setpoint, config): return Demand()\n"
    )
    scenario = load("microsat", {"control": {"law": f"{file}:idle"}})
    assert chosen_laws(scenario, "pd,lqr") == ("pd", "lqr", "idle")
    assert chosen_laws(scenario, "idle") == ("idle",)


@pytest.mark.parametrize("text", ["pd,pdd", "", "pd,"])
def test_unknown_laws_are_named(text):
    with pytest.raises(HarnessError, match=f"--laws {text}: there is no law '{text.partition(',')[2]}'"):
        chosen_laws(load("microsat"), text)


def test_all_else_is_the_same():
    settings = {"control": {"k_w": 5e6}, "body": {"inertia_kgm2": [1.0, 2.0, 2.5]}}
    found = cases("microsat", settings, ("pd", "lqr"), BOTH, 7, 0.5)
    assert [(case.law, case.driver) for case in found] == [
        (law, driver) for driver in BOTH for law in ("pd", "lqr")
    ]
    for case in found:
        scenario = load(case.order.scenario, case.order.overrides)
        assert (scenario.control.law, scenario.coils.driver) == (case.law, case.driver)
        assert (scenario.control.k_w, scenario.body.inertia_kgm2) == (5e6, (1.0, 2.0, 2.5))
        assert (case.order.seed, case.order.orbits) == (7, 0.5)


@pytest.mark.parametrize("scenario", ["microsat", "realsat"])
def test_a_law_that_plans_pulses_is_not_flown_by_a_continuous_driver(scenario):
    """Not even where it is the scenario's own."""
    found = cases(scenario, {}, ("mpc", "pulse_mpc"), BOTH, 1, None)
    assert [(case.law, case.driver) for case in found] == [
        ("mpc", Driver.PULSED),
        ("pulse_mpc", Driver.PULSED),
        ("mpc", Driver.CONTINUOUS),
    ]


@pytest.mark.parametrize(
    ("scenario", "holding", "driving"),
    [("microsat", False, False), ("pitch-wheel", True, False), ("microsat-wheel", False, True)],
)
def test_laws_of_a_wheel_are_compared_where_there_is_one(scenario, holding, driving):
    found = set(chosen_laws(load(scenario), "all"))
    assert ({"dual_spin", "six_gain", "wheel_relay"} <= found) is holding
    assert ({"two_coils", "wheel_allocation", "pitch_wheel"} <= found) is driving
    assert bool({"dual_spin", "two_coils"} & found) is (holding or driving)


def test_a_law_that_is_named_and_has_not_its_wheel_is_refused():
    assert chosen_laws(load("microsat"), "two_coils") == ("two_coils",)
    with pytest.raises(TableError, match=r"control\.law = 'two_coils' is not allowed without \[wheel\]"):
        cases("microsat", {}, ("pd", "two_coils"), BOTH, 1, None)


def test_full_scale_is_the_highest_level_unless_the_scenario_has_one():
    def full_scale(scenario, settings=None):
        (case,) = cases(scenario, settings or {}, ("pd",), (Driver.CONTINUOUS,), 1, None)
        return load(scenario, case.order.overrides).coils.max_dipole_am2

    assert full_scale("microsat") == 8.0
    assert full_scale("microsat", {"coils": {"max_dipole_am2": 3.0}}) == 3.0
    assert full_scale("kalman-tons") == 200.0


def test_a_scenario_of_a_continuous_driver_flies_pulses_too():
    (case,) = cases("tumbling", {}, ("pd",), (Driver.PULSED,), 1, None)
    assert load("tumbling", case.order.overrides).coils.driver == "pulsed"
