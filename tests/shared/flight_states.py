"""Flight states that a test keeps: a step changes its own copy, and what is altered is another state."""

from fsw.core.packing import copy_state
from fsw.core.step import step


def stepped(state, inbox, config):
    """The state after a step, and the outbox; the given state stays as it was."""
    after = copy_state(state)
    return after, step(after, inbox, config)


def altered(state, **fields):
    """A copy of a state in which these fields have other values."""
    other = copy_state(state)
    for name, value in fields.items():
        assert hasattr(other, name), name
        setattr(other, name, value)
    return other
