"""Buses that play a part, without flight software."""

import time
from collections import deque

import pytest

from fsw.wire.messages import PlantBoot, Sync


class ScriptedBus:
    """Frames wait in a queue, as on a bus; what the plant asks is answered as the script says.

    Args:
        there: frames that wait already.
        when_asked: answers each PLANT_BOOT.
        answer: the frames that answer the SYNC of a tick.
    """

    name = "scripted"

    def __init__(self, there=(), when_asked=(), answer=lambda tick: ()):
        self.queue = deque(there)
        self.when_asked = when_asked
        self.answer = answer
        self.sent = []
        self.closed = False

    def send(self, frames):
        for frame in frames:
            self.sent.append(frame)
            if frame.can_id == PlantBoot.ID:
                self.queue.extend(self.when_asked)
            if frame.can_id == Sync.ID:
                self.queue.extend(self.answer(Sync.decode(frame.data).tick))

    def receive(self, timeout_s):
        if self.queue:
            return self.queue.popleft()
        time.sleep(timeout_s)
        return None

    def close(self):
        self.closed = True


@pytest.fixture(scope="session")
def bus_of():
    """Makes a scripted bus."""
    return ScriptedBus
