"""A state in which all is well, and telecommands carried out on it."""

import pytest

from fsw.core.commands import command, decimal
from fsw.core.gate.readings import NOTHING
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import Elements
from fsw.core.orbit.ephemeris import advance
from fsw.core.step import boot
from fsw.wire.messages import (
    Mode,
    TcAckResult,
)

TICK = 40


@pytest.fixture(scope="module")
def itamsat(digits):
    """The elements as an orbit is made from them."""
    return Elements(*(decimal(*number) for number in digits.values()))


@pytest.fixture(scope="module")
def config(make_world):
    return make_world().config


@pytest.fixture(scope="module")
def state(config):
    """All is well: the attitude is known, the law has a memory, the orbit a window."""
    booted = boot(config)
    return booted._replace(
        tick=TICK,
        attitude=booted.attitude._replace(valid=True),
        modes=ModeState(Mode.ACQUIRE, 11, trips=1),
        memory=(0.25, -0.5),
        ephemeris=advance(None, TICK, config.ephemeris),
    )


@pytest.fixture(scope="module")
def obey(config):
    """Carries out telecommands: the state, and the results."""

    def through(state, *telecommands, violated=False, config=config):
        after, acks = command(state, NOTHING._replace(telecommands=telecommands), violated, config)
        assert [(ack.command, ack.command_counter, ack.tick) for ack in acks] == [
            (message.ID, message.counter, TICK) for message in telecommands
        ]
        return after, [TcAckResult(ack.result) for ack in acks]

    return through


@pytest.fixture
def refused(obey, state, leaves):
    """Whether the last of the telecommands is refused for this reason, and changes nothing."""

    def check(reason, *telecommands, start=state, **circumstances):
        before, _ = obey(start, *telecommands[:-1], **circumstances)
        after, results = obey(before, telecommands[-1], **circumstances)
        assert results == [reason]
        assert after is before

    return check
