"""The flight node: collects what is on the bus, and answers each SYNC with one step."""

import pytest
from flight_states import stepped

from fsw.core.gate.readings import INBOX_LIMIT
from fsw.core.gate.second_sender import SIGNS
from fsw.core.gate.sync_watch import LEAP_S
from fsw.core.state import Inbox
from fsw.core.step import boot
from fsw.node import MOST_INBOX_FRAMES, NO_PLANT_S, End, FlightNode
from fsw.table.config import flight_config
from fsw.table.table import load_flight_table
from fsw.wire.frame import EXTENDED_FLAG, Frame
from fsw.wire.messages import (
    FswBoot,
    FswEvent,
    MagField,
    PlantBoot,
    PlantEnd,
    SunVector,
    Sync,
    TickDone,
    intact,
)

FIELD = MagField(1, 20000.0, -7000.0, 31000.0).encode()
SUN = SunVector(1, 0.6, -0.48, 0.64).encode()


@pytest.fixture(scope="module")
def config():
    return flight_config(load_flight_table(None))


@pytest.fixture
def node(config):
    return FlightNode(config)


def sync(config, tick):
    return Sync(tick, config.epoch_unix_s + tick).encode()


def test_begins_with_fsw_boot_and_the_checksum_of_its_table(node, config):
    frame = node.start()
    assert intact(frame)
    assert FswBoot.decode(frame.data).table_crc == config.table_crc


def test_answers_nothing_before_sync(node):
    assert node.receive(FIELD) == ()
    assert node.receive(SUN) == ()
    assert node.state.tick == -1


def test_answers_sync_with_a_step_over_what_came_before_it(node, config):
    node.receive(FIELD)
    node.receive(SUN)
    answer = node.receive(sync(config, 0))
    state, expected = stepped(boot(config), Inbox(0, config.epoch_unix_s, (FIELD, SUN)), config)
    assert answer == expected
    assert node.state.gate == state.gate
    assert TickDone.decode(answer[-1].data).tick == 0


def test_what_came_before_one_sync_is_not_seen_at_the_next(node, config):
    node.receive(FIELD)
    node.receive(sync(config, 0))
    node.receive(sync(config, 1))
    assert node.state.field_tick == 0
    assert node.state.tick == 1


@pytest.mark.parametrize("change", [lambda f: f.replace(data=f.data[:-1]), lambda f: f.replace(data=b"")])
def test_a_sync_of_the_wrong_length_is_no_sync(node, config, change):
    assert node.receive(change(sync(config, 0))) == ()
    node.receive(sync(config, 0))
    assert node.state.gate.rejected == 1


def test_an_extended_frame_under_sync_s_number_is_no_sync(node, config):
    frame = sync(config, 0)
    assert node.receive(frame.replace(can_id=frame.can_id | EXTENDED_FLAG)) == ()


def test_a_sync_that_repeats_its_tick_is_answered_with_nothing(node, config):
    assert node.receive(sync(config, 5))
    assert node.receive(sync(config, 5)) == ()
    assert node.receive(sync(config, 4)) == ()
    assert node.state.ignored_syncs == 2


def test_a_flood_is_bounded_and_counted(node, config):
    for _ in range(MOST_INBOX_FRAMES + 500):
        node.receive(Frame(0x7FF, b""))
    assert len(node._inbox) == MOST_INBOX_FRAMES
    node.receive(sync(config, 0))
    assert node.state.gate.overrun == MOST_INBOX_FRAMES - 64
    assert len(node._inbox) == 0


@pytest.mark.requirement("REQ-BUS-05")
class TestEnd:
    @pytest.fixture
    def run(self, node, config):
        """A node that has answered tick 6."""
        node.receive(sync(config, 6))
        return node

    def test_is_heard_when_it_is_intact(self, run):
        end = PlantEnd(7).encode()
        run.receive(end.replace(data=bytes((end.data[0] ^ 1,)) + end.data[1:]))
        assert run.end is End.NO
        run.receive(end)
        assert run.ended

    @pytest.mark.parametrize("ticks", [0, 6, 8 + LEAP_S, 1000, 2**24 - 1])
    def test_of_another_count_is_none(self, run, ticks):
        run.receive(PlantEnd(ticks).encode())
        assert run.end is End.NO

    @pytest.mark.parametrize("ticks", [8, 7 + LEAP_S])
    def test_of_a_tick_near_ahead_is_in_doubt_until_a_sync_is_answered(self, run, config, ticks):
        run.receive(PlantEnd(ticks).encode())
        run.receive(PlantEnd(1000).encode())
        assert run.end is End.DOUBTED
        run.receive(sync(config, 3))
        assert run.end is End.DOUBTED
        run.receive(sync(config, 7))
        assert run.end is End.NO

    def test_before_the_first_tick_is_of_another_run(self, node):
        for ticks in (0, 7):
            node.receive(PlantEnd(ticks).encode())
        assert node.end is End.NO

    def test_of_a_long_run_is_told_modulo_2_to_the_24(self, node, config):
        node.receive(sync(config, 2**24 + 6))
        node.receive(PlantEnd(7).encode())
        assert node.ended


def test_a_plant_that_starts_is_heard_before_the_first_tick_alone(node, config):
    start = PlantBoot(0, 1, 2).encode()
    assert node.is_boot_request(start)
    assert not node.is_boot_request(FIELD)
    assert not node.is_boot_request(start.replace(data=start.data[:-1] + b"\0"))
    node.receive(sync(config, 0))
    assert not node.is_boot_request(start)


def test_the_boot_of_a_plant_displaces_no_frame_of_a_tick(node, config):
    """A log has none of those that a plant repeats while it waits for FSW_BOOT."""
    other = FlightNode(config)
    for _ in range(3):
        node.receive(PlantBoot(0, 1, 2).encode())
    for each in (node, other):
        for _ in range(INBOX_LIMIT):
            each.receive(SUN)
        each.receive(FIELD)
    assert node.receive(sync(config, 0)) == other.receive(sync(config, 0))


def test_a_plant_that_starts_anew_is_heard_when_there_has_been_none_for_a_while(node, config):
    """In its tick 0 a plant says so too, and a stranger may at any time."""
    start = PlantBoot(0, 1, 2).encode()
    node.receive(sync(config, 500))
    assert not node.is_boot_request(start, NO_PLANT_S)
    assert node.is_boot_request(start, NO_PLANT_S + 0.1)
    assert not node.is_boot_request(FIELD, NO_PLANT_S + 0.1)


def test_after_fsw_boot_nothing_is_left_of_the_flight_before(node, config):
    """So that a log that begins with it can be flown again."""
    for tick in (500, 501, 3):
        node.receive(FIELD)
        node.receive(sync(config, tick))
    node.receive(PlantEnd(502).encode())
    node.start()
    node.receive(FIELD)
    new = FlightNode(config)
    new.start()
    new.receive(FIELD)
    assert node.end is End.NO
    assert node.receive(sync(config, 0)) == new.receive(sync(config, 0))


@pytest.mark.requirement("REQ-BUS-03")
@pytest.mark.parametrize("strange", [0, 5, 10**9])
def test_what_came_before_a_sync_that_is_not_answered_counts_for_the_next(node, config, strange):
    node.receive(sync(config, 5))
    undisturbed = node.copy()
    for one in (node, undisturbed):
        one.receive(FIELD)
        if one is node:
            assert one.receive(sync(config, strange)) == ()
        one.receive(SUN)
    answers = [one.receive(sync(config, 6)) for one in (node, undisturbed)]
    assert node.state.field_tick == undisturbed.state.field_tick == 6
    assert [frame for frame in answers[0][:-1] if frame.can_id != FswEvent.ID] == list(answers[1][:-1])


def test_a_flood_of_strange_syncs_is_bounded(node, config):
    node.receive(sync(config, 5))
    for i in range(3 * MOST_INBOX_FRAMES):
        node.receive(Frame(0x7FF, b""))
        node.receive(sync(config, 10**9 + 7 * i))
    assert len(node._inbox) == MOST_INBOX_FRAMES
    node.receive(sync(config, 6))
    assert node.state.tick == 6
    assert not node._inbox


@pytest.mark.requirement("REQ-BUS-04")
@pytest.mark.parametrize("first", [10**9, 500, 0])
def test_a_wrong_sync_does_not_deafen(node, config, first):
    """A wrong first one, and two forged ones: the true ones are answered from the next but one on."""
    done = []
    for tick in (first, first + 1, *range(3, 50)):
        answer = node.receive(sync(config, tick))
        done += [TickDone.decode(frame.data).tick for frame in answer if frame.can_id == TickDone.ID]
    assert done[-46:] == list(range(4, 50))


def test_one_sync_from_far_ahead_moves_nothing(node, config):
    node.receive(sync(config, 0))
    assert node.receive(sync(config, LEAP_S + 1)) == ()
    assert node.state.ignored_syncs == 1
    assert TickDone.decode(node.receive(sync(config, 1))[-1].data).tick == 1
    assert TickDone.decode(node.receive(sync(config, 1 + LEAP_S))[-1].data).tick == 1 + LEAP_S


def test_a_leap_is_believed_when_the_next_sync_goes_on_from_it(node, config):
    node.receive(sync(config, 5))
    assert node.receive(sync(config, 1000)) == ()
    assert node.receive(sync(config, 1002)) == ()
    assert TickDone.decode(node.receive(sync(config, 1003))[-1].data).tick == 1003
    assert node.state.ignored_syncs == 2


def test_a_leap_is_forgotten_once_time_goes_on_as_before(node, config):
    node.receive(sync(config, 5))
    node.receive(sync(config, 1000))
    node.receive(sync(config, 6))
    assert node.receive(sync(config, 1001)) == ()
    assert node.state.tick == 6


def test_the_first_sync_may_be_any_tick(node, config):
    assert TickDone.decode(node.receive(sync(config, 90_000))[-1].data).tick == 90_000


@pytest.mark.requirement("REQ-BUS-01", "REQ-BUS-02")
@pytest.mark.parametrize("count", [1, 2])
def test_on_the_loop_bus_a_node_hears_the_others_of_its_kind_and_never_itself(open_link, config, count):
    clock = open_link()
    ends = [(open_link(), FlightNode(config)) for _ in range(count)]
    for link, node in ends:
        link.send([node.start()])
    for tick in range(SIGNS + 1):
        clock.send([sync(config, tick)])
        for link, node in ends:
            answer = ()
            while not answer:
                answer = node.receive(link.receive(10.0))
            link.send(answer)
        for _ in ends:
            while clock.receive(10.0).can_id != TickDone.ID:
                pass
    assert [node.state.second_sender.detected for _, node in ends] == [count > 1] * count
