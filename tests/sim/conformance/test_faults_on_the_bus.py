"""The conformance suite finds each planted fault of what a board sends and takes."""

import pytest
from compiled_guard import interpreted_alone

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilHeartbeat,
    CoilRefused,
    CoilStatus,
    PlantBoot,
    TickDone,
)
from hil_stub.bench import Bench, CoilBoard
from hil_stub.coils.coil_driver import CoilLimits
from sim.conformance.board_under_test import BoardLimits
from sim.conformance.command import run_checks

pytestmark = interpreted_alone()


class FaultyBench(Bench):
    """A bench whose frames, in and out, pass through what a fault makes of them."""

    outward = staticmethod(lambda frames, tick: frames)
    takes = staticmethod(lambda frame: True)

    def switch_on(self, *args, **kwargs):
        return self.outward(super().switch_on(*args, **kwargs), self._tick)

    def receive(self, frame, now_ms=0):
        if not self.takes(frame):
            return []
        sent = super().receive(frame, now_ms)
        booted = any(f.can_id == CoilBoot.ID for f in sent)
        return sent if booted else self.outward(sent, self._tick)


def changed(message_type, change):
    """Every message of that type, changed."""

    def outward(frames, tick):
        out = []
        for frame in frames:
            if frame.can_id == message_type.ID:
                message = change(message_type.decode(frame.data), tick)
                out += [] if message is None else [message.encode()]
            else:
                out.append(frame)
        return out

    return {"outward": staticmethod(outward)}


def times(number):
    """COIL_STATUS so many times in every seventh tick."""

    def outward(frames, tick):
        again = number if tick % 7 == 3 else 1
        return [f for frame in frames for f in [frame] * (again if frame.can_id == CoilStatus.ID else 1)]

    return {"outward": staticmethod(outward)}


def break_crc(frames, tick):
    return [Frame(f.can_id, f.data[:-1] + b"\0") if tick % 50 == 49 else f for f in frames]


def believes_one(self, tick):
    return (
        self.switch_on(tick, self._now_ms) if tick not in (self._tick, self._tick + 1) else follow(self, tick)
    )


follow = Bench._follow


def fed_by_any(self, tick):
    self._synced_tick = None
    return follow(self, tick)


def deaf_to_equals(self, tick):
    return [] if tick == self._unexpected_sync else follow(self, tick)


def never_back(self, tick):
    return [] if tick < self._tick else follow(self, tick)


def never_forgets(self, tick):
    kept = self._unexpected_sync
    frames = follow(self, tick)
    self._unexpected_sync = self._unexpected_sync or kept
    return frames


def few_refusals(frames, tick):
    """No more than 63 in a tick."""
    refused = [frame for frame in frames if frame.can_id == CoilRefused.ID]
    return [frame for frame in frames if frame not in refused[63:]]


def restarts_always(self, frame, now_ms=0):
    return self.switch_on(now_ms=now_ms) if frame.can_id == PlantBoot.ID else receive(self, frame, now_ms)


def fed_by_answers(self, frame, now_ms=0):
    if frame.can_id == TickDone.ID:
        self._synced_ms = now_ms
    return receive(self, frame, now_ms)


receive = Bench.receive

ON_THE_BUS = {
    "no boot message": (changed(CoilBoot, lambda m, tick: None), "boot"),
    "no status now and then": (times(0), None),
    "two statuses now and then": (times(2), "all_along"),
    "a counter that stands still": (changed(CoilStatus, lambda m, tick: m.replace(counter=3)), "all_along"),
    "broken frames": ({"outward": staticmethod(break_crc)}, "all_along"),
    "no heartbeat": (changed(CoilHeartbeat, lambda m, tick: None), "heartbeats"),
    "a heartbeat of another tick": (
        changed(CoilHeartbeat, lambda m, tick: m.replace(tick=m.tick + 1)),
        "heartbeats",
    ),
    "a heartbeat that is always ready": (
        changed(CoilHeartbeat, lambda m, tick: m.replace(state=0)),
        "heartbeats",
    ),
    "a heartbeat without rejects": (
        changed(CoilHeartbeat, lambda m, tick: m.replace(rejects=0)),
        "heartbeats",
    ),
    "another bus contract": (changed(CoilBoot, lambda m, tick: m.replace(version=2)), "boot"),
    "few refusals of a flood": ({"outward": staticmethod(few_refusals)}, "flood"),
    "PLANT_BOOT restarts it in tick 0 too": ({"receive": restarts_always}, "boot"),
    "an old TICK_DONE feeds the dead-man": ({"receive": fed_by_answers}, "repeated_tick"),
    "sign lost": (changed(CoilStatus, lambda m, tick: m.replace(level=abs(m.level))), "boot_lockout"),
    "always coil 0": (changed(CoilStatus, lambda m, tick: m.replace(coil=0)), "boot"),
    "no current": (changed(CoilStatus, lambda m, tick: m.replace(current_ma=0)), "back_off"),
    "current for ever": (changed(CoilStatus, lambda m, tick: m.replace(current_ma=-200)), "back_off"),
    "no lockout told": (changed(CoilStatus, lambda m, tick: m.replace(lockout_ms=0)), "boot"),
    "remaining_ms stands still": (
        changed(CoilStatus, lambda m, tick: m.replace(remaining_ms=3000 if m.level else 0)),
        "back_off",
    ),
    "seq not told": (changed(CoilStatus, lambda m, tick: m.replace(seq=0)), "boot_lockout"),
    "silent refusals": (changed(CoilRefused, lambda m, tick: None), "boot_lockout"),
    "refusals of another seq": (changed(CoilRefused, lambda m, tick: m.replace(seq=m.seq + 1)), "refusals"),
    "refusals of another tick": (
        changed(CoilRefused, lambda m, tick: m.replace(tick=m.tick + 1)),
        "refusals",
    ),
    "PLANT_BOOT is not heard": ({"takes": staticmethod(lambda f: f.can_id != PlantBoot.ID)}, "boot"),
    "lost count is not noticed": (
        {"_follow": lambda self, t: follow(self, min(t, self._tick + 1))},
        "lost_count",
    ),
    "one strange SYNC is believed": ({"_follow": believes_one}, "noise"),
    "two of one tick are not believed": ({"_follow": deaf_to_equals}, "lost_count"),
    "two backwards are not believed": ({"_follow": never_back}, "lost_count"),
    "a good SYNC does not end a row of strange ones": ({"_follow": never_forgets}, "lost_count"),
    "a SYNC that repeats its tick feeds the dead-man": ({"_follow": fed_by_any}, "repeated_tick"),
    "the dead-man is not told": (
        {"outward": staticmethod(lambda frames, tick: [f for f in frames if f.can_id != 0x420])},
        "dead_man",
    ),
}


@pytest.mark.parametrize(("parts", "finds"), ON_THE_BUS.values(), ids=ON_THE_BUS)
def test_a_fault_on_the_bus_is_found(link_to, parts, finds, failures):
    faulty = type("Faulty", (FaultyBench,), parts)
    found = failures(
        run_checks(link_to(lambda: CoilBoard(CoilLimits(1)), bench=faulty), BoardLimits(), armed=True)
    )
    assert found
    assert finds is None or finds in found, found


def test_no_heartbeat_is_found_without_pulses_too(link_to, failures):
    """The board is kept awake until one is due."""
    faulty = type("Faulty", (FaultyBench,), ON_THE_BUS["no heartbeat"][0])
    link = link_to(lambda: CoilBoard(CoilLimits(1)), bench=faulty)
    found = failures(run_checks(link, BoardLimits(), armed=False))
    assert found == {"heartbeats": "no heartbeat in tick 60, 60 s after boot or the last one"}


def test_without_a_boot_message_no_heartbeat_is_called_in_time(link_to, failures):
    faulty = type("Faulty", (FaultyBench,), ON_THE_BUS["no boot message"][0])
    link = link_to(lambda: CoilBoard(CoilLimits(1)), bench=faulty)
    found = failures(run_checks(link, BoardLimits(), armed=False))
    assert "no boot message" in found["heartbeats"]
