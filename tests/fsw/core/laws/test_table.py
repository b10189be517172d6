"""The table of laws: complete, unmistakable, and no law asks for what it cannot know."""

from dataclasses import fields, is_dataclass, replace
from importlib import import_module
from math import isfinite
from pathlib import Path

import pytest
from flight_states import altered

from fsw.core import laws
from fsw.core.algebra.quaternion import normalise
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.attitude import UNKNOWN, Attitude
from fsw.core.laws.interface import Demand, FieldSample, LawInput
from fsw.core.laws.plan.pulse_model import NO_PULSE
from fsw.core.laws.table import LAWS
from fsw.core.state_bytes import checksum
from fsw.core.step import boot
from fsw.table.config import flight_config
from fsw.table.table import flight_table

CONFIG = flight_config(flight_table({"body": {"wheel_nms": [0.01, -0.02, 0.03]}}, "table"))
CONTROL = CONFIG.control
SETPOINT = replace(CONTROL.setpoint, k_i=0.05, spin_radps=0.01)
KNOWN = Attitude(normalise((0.9, 0.1, -0.2, 0.3)), (0.001, -0.002, 0.003), 0.01, 1e-4, True)
NOT_VALID = KNOWN.invalid()
B_BODY_T = (1.7e-5, -2.3e-5, 3.1e-5)
SAMPLE = FieldSample((1.6e-5, -2.4e-5, 3.2e-5), tick=44)
BEFORE = FieldSample((1.5e-5, -2.6e-5, 3.3e-5), tick=43)

MEASURED = {"bdot", "bdot_held", "bdot_switched", "nutation", "y_thomson", "spin_up", "slow_spin"}
"""Laws that fly on the magnetometer alone, and may speak before the attitude is known."""

EVERY_LAW = pytest.mark.parametrize("name", LAWS)
BOTH = pytest.mark.parametrize("mode", ["acquire", "point"])


def asks_for_nothing(demand):
    """Whatever it remembers."""
    return demand.pulse in (None, NO_PULSE) and demand.replace(memory=(), pulse=None) == Demand()


def blind(attitude):
    """Nothing is known or measured."""
    return LawInput(attitude, ZERO, FieldSample(), FieldSample())


def asked(name, mode, inputs, memory=()):
    return getattr(LAWS[name], mode)(inputs, memory, replace(SETPOINT, law=name), CONTROL)


def test_numbers_are_unique_and_fit_a_telecommand():
    numbers = [row.number for row in LAWS.values()]
    assert len(set(numbers)) == len(numbers)
    assert all(0 <= number <= 255 for number in numbers)


def test_every_file_of_laws_is_in_the_table_and_none_takes_the_name_of_anothers_law():
    modules = [
        import_module(f"fsw.core.laws.{path.stem}")
        for path in Path(laws.__file__).parent.glob("*.py")
        if path.stem not in ("__init__", "table", "by_mode")
    ]
    names = [name for module in modules for name in getattr(module, "LAWS", {})]
    assert len(names) > 60
    assert sorted(names) == sorted(LAWS)


def test_the_numbers_of_the_first_laws_stay_what_they_were():
    """Who has written them down relies on them."""
    first = {"pd": 0, "rate_damping": 1, "bdot": 2, "predictive": 3}
    assert {name: LAWS[name].number for name in first} == first


@EVERY_LAW
def test_own_gains_are_a_frozen_dataclass_of_floats_with_defaults(name):
    gains = LAWS[name].gains
    if gains is None:
        assert name not in CONTROL.gains
        return
    assert is_dataclass(gains)
    values = gains()
    assert fields(values)
    for field in fields(values):
        assert isfinite(getattr(values, field.name))
        with pytest.raises(AttributeError):
            setattr(values, field.name, 0.0)


@EVERY_LAW
@BOTH
@pytest.mark.parametrize("attitude", [UNKNOWN, NOT_VALID], ids=["unknown", "not valid"])
def test_a_law_that_knows_and_measures_nothing_asks_for_nothing(name, mode, attitude):
    assert asks_for_nothing(asked(name, mode, blind(attitude)))


@EVERY_LAW
@BOTH
def test_an_attitude_that_is_not_valid_is_not_looked_at(name, mode):
    """Whatever it says: as if it were another one."""
    other = Attitude(normalise((0.2, -0.5, 0.7, 0.1)), (0.1, 0.2, -0.3), 1.0, 1.0, False)
    first, second = (
        asked(name, mode, LawInput(attitude, B_BODY_T, SAMPLE, BEFORE)) for attitude in (NOT_VALID, other)
    )
    assert first == second
    if name not in MEASURED:
        assert asks_for_nothing(first)


@EVERY_LAW
@BOTH
def test_without_a_field_no_dipole_is_asked_for(name, mode):
    """There is nothing to push against; and nothing is divided by it."""
    demand = asked(name, mode, blind(KNOWN))
    assert demand.m_body_am2 == ZERO
    assert all(isfinite(c) for c in demand.memory)


@EVERY_LAW
@BOTH
def test_a_law_is_a_function_and_takes_back_what_it_remembered(name, mode):
    inputs = LawInput(KNOWN, B_BODY_T, SAMPLE, BEFORE, (0.6, 0.0, 0.8))
    once, again = asked(name, mode, inputs), asked(name, mode, inputs)
    assert once == again
    later = asked(name, mode, inputs, once.memory)
    assert len(later.memory) == len(once.memory)
    assert all(isinstance(c, float) and isfinite(c) for c in later.memory)


def test_every_law_has_its_own_place_in_the_checksum():
    state = boot(CONFIG)
    sums = {checksum(altered(state, setpoint=replace(SETPOINT, law=name))) for name in LAWS}
    assert len(sums) == len(LAWS)


@pytest.mark.parametrize("field", ["k_w", "k_a", "k_i", "spin_radps"])
def test_every_number_of_the_setpoint_shows_in_the_checksum(field):
    state = altered(boot(CONFIG), setpoint=SETPOINT)
    changed = replace(SETPOINT, **{field: getattr(SETPOINT, field) * (1.0 + 2.0**-52)})
    assert checksum(altered(state, setpoint=changed)) != checksum(state)


@pytest.mark.parametrize("memory", [(), (0.0,), (1.0,), (0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, 5e-324)])
def test_memory_shows_in_the_checksum_by_value_place_and_length(memory):
    state = boot(CONFIG)
    others = [(), (0.0,), (1.0,), (0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.0, 5e-324)]
    same = [
        other
        for other in others
        if checksum(altered(state, memory=other)) == checksum(altered(state, memory=memory))
    ]
    assert same == [memory]


def test_what_is_held_and_paid_and_driven_shows_in_the_checksum():
    state = boot(CONFIG)
    one = (0.0, 5e-324, 0.0)
    changed = [
        altered(state, pulses=replace(state.pulses, held_am2=one)),
        altered(state, coil=replace(state.coil, paid_body_nms=one)),
        altered(state, coil=replace(state.coil, driven_am2=one)),
    ]
    assert len({checksum(each) for each in (state, *changed)}) == 4
