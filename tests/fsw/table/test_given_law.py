"""A law given as an object: the name in a table, the digest of its source, and where it is known."""

from dataclasses import dataclass
from functools import partial
from threading import Thread

import pytest

from fsw.input.schema import TableError
from fsw.own_law import ControlLaw, Demand, quantity
from fsw.table.given_law import given_law, standing


def idle(inputs, memory, setpoint, config):
    return Demand()


def other(inputs, memory, setpoint, config):
    return Demand((1.0, 0.0, 0.0))


def gains_of(default):
    @dataclass(frozen=True)
    class Gains:
        k: float = quantity(default, "1")

    return Gains


class Held:
    """A law that is no function."""

    def __call__(self, inputs, memory, setpoint, config):
        return Demand()

    def method(self, inputs, memory, setpoint, config):
        return Demand()


bound = ControlLaw(idle)
short = lambda inputs, memory, setpoint, config: Demand()  # noqa: E731  as a user may write one
held = Held()
part = partial(idle)


def nested():
    def idle(inputs, memory, setpoint, config):
        return Demand()

    return idle


@pytest.mark.parametrize(
    ("law", "name", "known"),
    [
        (idle, "idle", True),
        (bound, "bound", True),
        (ControlLaw(idle), "idle", True),
        (short, "short", False),
        (lambda *inputs: Demand(), "<lambda>", False),
        (ControlLaw(short), "<lambda>", False),
        (held, "held", False),
        (Held(), "Held", False),
        (held.method, "Held.method", True),
        (nested(), "nested.<locals>.idle", True),
    ],
)
def test_its_name_and_whether_its_source_is_known(law, name, known):
    with standing(law) as reference:
        assert reference == f"object {__name__}:{name}"
        assert given_law().law is law
        assert (given_law().sha256 is not None) == known
    assert given_law() is None


def test_a_partial_has_the_name_of_its_variable_where_that_is_found():
    with standing(part) as reference:
        assert reference == "object functools:partial"
        assert given_law().sha256 is None


def sha256(law):
    with standing(law):
        return given_law().sha256


def test_the_digest_is_of_all_that_flies():
    laws = [
        idle,
        other,
        ControlLaw(idle),
        ControlLaw(idle, other),
        ControlLaw(idle, gains=gains_of(1.0)),
        ControlLaw(idle, gains=gains_of(2.0)),
    ]
    assert len({sha256(law) for law in laws}) == len(laws)
    assert sha256(ControlLaw(idle, gains=gains_of(1.0))) == sha256(laws[4])


def test_another_thread_does_not_know_it():
    found = []
    with standing(idle), standing(other):
        thread = Thread(target=lambda: found.append(given_law()))
        thread.start()
        thread.join()
        assert given_law().law is other
    assert found == [None]


def test_what_is_no_law():
    with pytest.raises(TableError, match=r"law = 3: give FILE\.py:NAME"), standing(3):
        pass
