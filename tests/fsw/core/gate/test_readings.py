"""The decode gate: a frame is taken whole or not at all, and everything else is counted."""

from random import Random
from zlib import crc32

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsw.core.gate.readings import (
    INBOX_LIMIT,
    INPUT_MESSAGES,
    NOTHING,
    TELECOMMANDS,
    GateState,
    Readings,
    admit,
)
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    CoilBoot,
    CoilDipoleStatus,
    CoilHeartbeat,
    CoilRefused,
    CoilStatus,
    MagBoot,
    MagField,
    NavQuality,
    NavRate,
    PlantBoot,
    PlantEnd,
    RefAttitude,
    RefRate,
    SunVector,
    Sync,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
    TickDone,
    intact,
)

FIELD = MagField(1, 20000.0, -7000.0, 31000.0, counter=5)
SUN = SunVector(1, 0.599975586, -0.47998046875, 0.64001464, counter=6)
COIL = CoilStatus(-2, 1, 2000, -150, 103000, 9, counter=7)
REFUSED = CoilRefused(2, 9, 8, 0xC3, counter=8)
ATTITUDE = RefAttitude(1, 0.5, -0.25, 0.125, counter=9)
RATE = RefRate(1, 2.0**-7, -(2.0**-8), 2.0**-9, counter=10)
DIPOLE = CoilDipoleStatus(0.5, -0.25, 2.0**-16, counter=11)
BOOT = CoilBoot(1, 1, 0x89ABCDEF, counter=12)
COUNTED = (FIELD, SUN, COIL, REFUSED, ATTITUDE, RATE, DIPOLE)
END = PlantEnd(9000, counter=13)
EVERY_KIND = (*COUNTED, BOOT, END)
SLOT = {message.ID: slot for slot, message in enumerate(EVERY_KIND)}
EVERY_MESSAGE = pytest.mark.parametrize("message", EVERY_KIND, ids=lambda m: type(m).__name__)
EVERY_COUNTED = pytest.mark.parametrize("message", COUNTED, ids=lambda m: type(m).__name__)


def frames(*messages):
    return tuple(message.encode() for message in messages)


def admitted(*messages, state=None):
    raw = tuple(m if isinstance(m, Frame) else m.encode() for m in messages)
    return admit(raw, state or GateState())


def broken(frame):
    return frame._replace(data=bytes((frame.data[0] ^ 0x20,)) + frame.data[1:])


def test_an_empty_inbox_tells_nothing_and_changes_nothing():
    assert admit((), GateState()) == (NOTHING, GateState())


def test_what_is_listened_to_is_what_this_test_sends():
    assert list(INPUT_MESSAGES) == [message.ID for message in EVERY_KIND]


def test_every_kind_is_taken_as_sent():
    as_sent = (BOOT, *COUNTED, END)  # a board that starts says so first
    readings, state = admit(frames(*as_sent), GateState())
    assert tuple(readings[: len(EVERY_KIND)]) == tuple(type(m).decode(m.encode().data) for m in EVERY_KIND)
    assert readings.coil == COIL
    assert readings.field == FIELD
    input_crc = crc32(b"".join(message.encode().data for message in as_sent[:-1]))
    counters = (*range(5, 14), *(-1,) * len(TELECOMMANDS))
    assert state == GateState(counters, input_crc=input_crc, command_crc=crc32(END.encode().data))


@EVERY_MESSAGE
class TestEachMessage:
    def test_is_the_only_one_heard(self, message):
        readings, _ = admitted(message)
        assert [type(one) for one in readings._replace(quiet=False) if one] == [type(message)]

    def test_broken_crc(self, message):
        assert admitted(broken(message.encode())) == (NOTHING, GateState(rejected=1))

    @pytest.mark.parametrize("change", [lambda d: d[:-1], lambda d: d + b"\0", lambda d: b""])
    def test_wrong_length(self, message, change):
        frame = message.encode()
        assert admitted(frame._replace(data=change(frame.data))) == (NOTHING, GateState(rejected=1))

    @pytest.mark.parametrize("flag", [EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG])
    def test_flagged_frames_are_never_ours(self, message, flag):
        frame = message.encode()
        flagged = frame._replace(can_id=frame.can_id | flag)
        assert admitted(flagged) == (NOTHING, GateState(rejected=1))

    def test_every_bit_that_is_taken_shows_in_the_state(self, message):
        """Also where nobody has a use for it."""
        _, state = admitted(message)
        data = message.encode().data
        for bit in range(8 * (len(data) - 1)):
            altered = bytes(byte ^ (bit // 8 == index) << bit % 8 for index, byte in enumerate(data))
            again = type(message).decode(altered).encode()  # sealed anew; bits that mean nothing are 0 again
            _, other = admitted(again)
            assert again.data == data or other != state

    def test_the_first_one_is_taken_whatever_its_counter(self, message):
        for counter in range(16):
            readings, state = admitted(message._replace(counter=counter))
            assert readings != NOTHING
            assert (state.rejected, state.missed) == (0, 0)

    def test_forty_in_order_miss_nothing(self, message):
        state = GateState()
        for counter in range(40):
            readings, state = admitted(message._replace(counter=counter), state=state)
            assert readings != NOTHING
        assert (state.rejected, state.missed) == (0, 0)

    def test_the_last_of_several_counts(self, message):
        readings, _ = admitted(*(message._replace(counter=n) for n in (3, 4, 5)))
        assert readings[SLOT[message.ID]].counter == 5

    def test_a_broken_one_does_not_displace_a_good_one(self, message):
        readings, _ = admitted(message._replace(counter=3), broken(message._replace(counter=4).encode()))
        assert readings[SLOT[message.ID]].counter == 3

    def test_the_counters_of_others_do_not_move(self, message):
        _, state = admit(frames(*EVERY_KIND), GateState())
        _, later = admitted(message._replace(counter=message.counter + 1), state=state)
        changed = [a != b for a, b in zip(state.counters, later.counters, strict=True)]
        assert changed == [can_id == message.ID for can_id in (*INPUT_MESSAGES, *TELECOMMANDS)]


@EVERY_COUNTED
class TestEachCounter:
    def test_repeated(self, message):
        readings, state = admitted(message, message)
        assert readings[SLOT[message.ID]] is not None
        assert (state.rejected, state.missed) == (1, 0)

    @pytest.mark.parametrize("counter", [0, 5, 15])
    def test_repeated_in_the_next_tick(self, message, counter):
        _, state = admitted(message._replace(counter=counter))
        readings, state = admitted(message._replace(counter=counter), state=state)
        assert readings == NOTHING
        assert (state.rejected, state.missed) == (1, 0)

    @pytest.mark.parametrize("first", [0, 13])
    @pytest.mark.parametrize("jump", range(1, 16))
    def test_a_jump_is_taken_and_what_is_missing_counted(self, message, first, jump):
        _, state = admitted(message._replace(counter=first))
        readings, state = admitted(message._replace(counter=first + jump), state=state)
        assert readings != NOTHING
        assert (state.rejected, state.missed) == (0, jump - 1)

    def test_a_broken_frame_does_not_move_the_counter(self, message):
        """What was rejected is missed when the next one comes."""
        _, state = admitted(message._replace(counter=1))
        _, state = admitted(broken(message._replace(counter=2).encode()), state=state)
        _, state = admitted(message._replace(counter=3), state=state)
        assert (state.rejected, state.missed) == (1, 1)


class TestBoot:
    """A board that starts counts anew: its first word is news whatever its counter, and none was missed."""

    @pytest.mark.parametrize("before", [0, 7, 15])
    @pytest.mark.parametrize("counter", range(16))
    def test_is_taken_whatever_was_heard_before(self, before, counter):
        _, state = admitted(BOOT._replace(counter=before))
        readings, state = admitted(BOOT._replace(counter=counter), state=state)
        assert readings.coil_boot == BOOT._replace(counter=counter)
        assert (state.rejected, state.missed) == (0, 0)

    def test_the_board_that_sent_it_counts_anew_and_the_others_go_on(self):
        _, before = admitted(*COUNTED)
        _, state = admitted(BOOT, COIL, FIELD, state=before)
        assert state.rejected == before.rejected + 1  # the field's counter did not move
        assert state.missed == before.missed
        assert state.counters[SLOT[COIL.ID]] == COIL.counter
        assert state.counters[SLOT[REFUSED.ID]] == state.counters[SLOT[DIPOLE.ID]] == -1
        assert state.counters[SLOT[SUN.ID]] == SUN.counter

    def test_a_broken_one_is_no_boot(self):
        assert admitted(broken(BOOT.encode())) == (NOTHING, GateState(rejected=1))


class TestRange:
    @pytest.mark.parametrize("level", range(-8, 8))
    def test_levels_of_a_coil(self, level):
        readings, state = admit(frames(COIL._replace(level=level)), GateState())
        assert (readings.coil is not None) is (-3 <= level <= 3)
        assert state.rejected == (not -3 <= level <= 3)

    @pytest.mark.parametrize("coil", range(4))
    def test_there_is_no_fourth_coil(self, coil):
        readings, state = admit(frames(COIL._replace(coil=coil)), GateState())
        assert (readings.coil is not None) is (coil < 3)
        assert state.rejected == (coil == 3)

    @pytest.mark.parametrize(
        ("length", "taken"), [(0.88, False), (0.91, True), (1.0, True), (1.09, True), (1.11, False)]
    )
    def test_a_direction_is_nearly_a_unit_vector(self, length, taken):
        sun = SUN._replace(s_x=0.6 * length, s_y=-0.48 * length, s_z=0.64 * length)
        readings, state = admit(frames(sun), GateState())
        assert (readings.sun is not None) is taken
        assert state.rejected == (not taken)

    def test_a_sun_sensor_that_sees_nothing_may_say_zero(self):
        readings, _ = admit(frames(SunVector(0, 0.0, 0.0, 0.0)), GateState())
        assert readings.sun == SunVector(0, 0.0, 0.0, 0.0)

    @pytest.mark.parametrize(
        ("vector", "taken"),
        [((0.6, -0.48, 0.64), True), ((0.999985, 0.0, 0.0), True), ((0.6, -0.48, 0.66), False)],
    )
    def test_a_reference_attitude_is_a_rotation(self, vector, taken):
        """The vector part of a unit quaternion is no longer than one, up to the wire's rounding."""
        readings, state = admit(frames(RefAttitude(1, *vector)), GateState())
        assert (readings.ref_attitude is not None) is taken
        assert state.rejected == (not taken)


class TestTheRest:
    @pytest.mark.parametrize("can_id", [0x000, 0x001, 0x111, 0x7FF, EXTENDED_FLAG, EXTENDED_FLAG | 0x110])
    def test_unknown_identifiers_are_counted(self, can_id):
        assert admit((Frame(can_id, bytes(8)),), GateState()) == (NOTHING, GateState(rejected=1))

    @pytest.mark.parametrize(
        "message",
        [
            PlantBoot(0, 1, 2),
            MagBoot(0, 1, 2),
            CoilHeartbeat(0, 0, 0, 60),
        ],
    )
    def test_what_is_meant_for_others_passes_uncounted(self, message):
        assert admit(frames(message), GateState()) == (NOTHING, GateState())

    def test_of_whole_frames_under_own_identifiers_the_lowest_is_told(self):
        rate, quality = NavRate(1, 0.0, 0.0, 0.0), NavQuality(0, 0.0, 0.0, 0, 0, 0, 0, 0, 0, 0)
        readings, state = admit(frames(quality, rate, quality, TickDone(1, 2)), GateState())
        assert readings == NOTHING._replace(under_own_id=NavRate.ID)
        assert state == GateState()
        assert admitted(broken(rate.encode())) == (NOTHING, GateState(rejected=1))

    @pytest.mark.parametrize(
        "frame",
        [
            broken(PlantBoot(0, 1, 2).encode()),
            Frame(CoilHeartbeat.ID, b"\x01\x02"),
            Frame(Sync.ID, bytes(7)),
        ],
    )
    def test_what_is_broken_is_counted_whoever_it_was_meant_for(self, frame):
        assert admit((frame,), GateState()) == (NOTHING, GateState(rejected=1))


class TestOverrun:
    def test_a_babbling_node_costs_no_more_than_the_limit(self):
        flood = tuple(FIELD._replace(counter=n).encode() for n in range(INBOX_LIMIT + 9))
        readings, state = admit(flood, GateState())
        assert readings.field.counter == (INBOX_LIMIT - 1) % 16
        assert (state.overrun, state.rejected, state.missed) == (9, 0, 0)

    def test_exactly_the_limit_is_no_overrun(self):
        _, state = admit(frames(*[FIELD._replace(counter=n) for n in range(INBOX_LIMIT)]), GateState())
        assert state.overrun == 0

    def test_what_lies_beyond_the_limit_is_not_read(self):
        noise = (Frame(0x7FF, b""),) * INBOX_LIMIT
        readings, state = admit((*noise, FIELD.encode()), GateState())
        assert readings == NOTHING
        assert (state.rejected, state.overrun) == (INBOX_LIMIT, 1)


TELECOMMAND_OF = {
    TcMode.ID: TcMode(2, counter=3),
    TcClear.ID: TcClear(counter=3),
    TcLaw.ID: TcLaw(10, counter=3),
    TcSpin.ID: TcSpin(-(2.0**-9), counter=3),
    TcGain.ID: TcGain(1, -1, 16149, counter=3),
    TcOrbitElement.ID: TcOrbitElement(4, -7, 8932, counter=3),
    TcOrbitLoad.ID: TcOrbitLoad(counter=3),
    TcParameter.ID: TcParameter(17, -9, -45678, counter=3),
    TcFreeze.ID: TcFreeze(1, counter=3),
}


@pytest.mark.parametrize("message", TELECOMMAND_OF.values(), ids=lambda m: type(m).__name__)
class TestTelecommands:
    """None is lost: all of one tick count, in their order, and a repeated one is told from a new one."""

    def test_is_the_only_one_heard(self, message):
        readings, state = admitted(message)
        assert readings == NOTHING._replace(telecommands=(message,))
        assert (state.input_crc, state.command_crc) == (0, crc32(message.encode().data))
        assert (state.rejected, state.missed) == (0, 0)

    def test_all_of_one_kind_count(self, message):
        sent = tuple(message._replace(counter=n & 0xF) for n in range(14, 20))
        readings, state = admitted(*sent)
        assert readings.telecommands == sent
        assert (state.rejected, state.missed) == (0, 0)

    def test_one_with_the_counter_of_the_one_before_is_told_apart(self, message):
        readings, state = admitted(message, message)
        assert (readings.telecommands, readings.repeated) == ((message,), (message,))
        assert state.rejected == 1
        readings, later = admitted(message, state=state)
        assert (readings.telecommands, readings.repeated) == ((), (message,))
        assert (later.rejected, later.command_crc) == (2, state.command_crc)

    def test_gaps_are_counted(self, message):
        readings, state = admitted(message, message._replace(counter=9))
        assert len(readings.telecommands) == 2
        assert state.missed == 5

    @pytest.mark.parametrize(
        "change", [lambda d: bytes((d[0] ^ 0x20,)) + d[1:], lambda d: d[:-1], lambda d: b""]
    )
    def test_a_broken_one_is_counted_and_nothing_else(self, message, change):
        frame = message.encode()
        assert admitted(frame._replace(data=change(frame.data))) == (NOTHING, GateState(rejected=1))


def test_telecommands_of_all_kinds_stay_in_their_order():
    sent = tuple(TELECOMMAND_OF[can_id] for can_id in reversed(TELECOMMANDS))
    readings, _ = admitted(FIELD, *sent[:3], COIL, *sent[3:])
    assert readings == NOTHING._replace(field=FIELD, coil=COIL, telecommands=sent)


def test_where_a_telecommand_stands_among_the_boards_messages_does_not_count():
    one = (TELECOMMAND_OF[TcSpin.ID], TELECOMMAND_OF[TcLaw.ID])
    orders = [(*one, FIELD, COIL), (one[0], FIELD, one[1], COIL), (FIELD, COIL, *one)]
    assert len({admitted(*order) for order in orders}) == 1
    assert admitted(*reversed(one), FIELD, COIL) != admitted(*orders[0])


def test_every_telecommand_is_listened_to():
    assert set(TELECOMMANDS) == {can_id for can_id, sender in SENDERS.items() if sender == "GROUND"}
    assert {can_id: CLASSES[can_id] for can_id in TELECOMMANDS} == TELECOMMANDS


def random_frame(random):
    """Nearly right: listened identifiers and right lengths often, flags and nonsense now and then."""
    can_id = random.choice([*INPUT_MESSAGES, *TELECOMMANDS, *CLASSES, random.getrandbits(11)])
    if random.random() < 0.1:
        can_id |= random.choice([EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG])
    known = CLASSES.get(can_id)
    length = known.LENGTH if known is not None and random.random() < 0.8 else random.randrange(9)
    return Frame(can_id, random.randbytes(length))


def test_of_ten_thousand_random_frames_none_is_taken_unless_intact():
    random, state, taken = Random(20000), GateState(), 0
    for _ in range(10_000):
        frame = random_frame(random)
        readings, after = admit((frame,), state)
        accepted = [message for message in (*readings[:-4], *readings.telecommands) if message is not None]
        if accepted:
            taken += 1
            assert intact(frame)
            assert accepted == [CLASSES[frame.can_id].decode(frame.data)]
            assert after.rejected == state.rejected
        elif frame.can_id in (*INPUT_MESSAGES, *TELECOMMANDS) or not intact(frame):
            assert after == state._replace(rejected=state.rejected + 1)
        state = after
    assert 0 < taken < 10_000 / 100  # a CRC of 8 bits lets one in 256 pass


@given(
    st.lists(
        st.builds(
            Frame,
            st.integers(0, 2**32 - 1) | st.sampled_from([*INPUT_MESSAGES, *TELECOMMANDS]),
            st.binary(max_size=64),
        ),
        max_size=80,
    )
)
@settings(max_examples=200, deadline=None)
def test_no_content_raises_and_every_frame_is_accounted_for(inbox):
    readings, state = admit(tuple(inbox), GateState())
    assert isinstance(readings, Readings)
    assert state.overrun == max(0, len(inbox) - INBOX_LIMIT)
    assert state.rejected <= len(inbox)
    assert all(-1 <= counter <= 15 for counter in state.counters)
