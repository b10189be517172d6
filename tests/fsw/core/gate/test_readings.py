"""The decode gate: a frame is taken whole or not at all, and everything else is counted."""

from zlib import crc32

import pytest
from gate_samples import (
    BOOT,
    CELLS,
    COIL,
    COUNTED,
    DIPOLE,
    END,
    EVERY_COUNTED,
    EVERY_KIND,
    EVERY_MESSAGE,
    FIELD,
    REFUSED,
    SLOT,
    SUN,
    WHEEL,
    admitted,
    broken,
    frames,
    taken,
)

from fsw.core.gate.readings import (
    INBOX_LIMIT,
    INPUT_MESSAGES,
    NOISE_LIMIT,
    TELECOMMANDS,
    GateState,
    Readings,
)
from fsw.wire.frame import ERROR_FLAG, EXTENDED_FLAG, REMOTE_FLAG, Frame
from fsw.wire.messages import (
    CoilHeartbeat,
    MagBoot,
    NavQuality,
    NavRate,
    PlantBoot,
    RefAttitude,
    SunVector,
    Sync,
    TcFreeze,
    TickDone,
)


def test_an_empty_inbox_tells_nothing_and_changes_nothing():
    assert admitted() == (Readings(), GateState())


def test_what_is_listened_to_is_what_this_test_sends():
    assert list(INPUT_MESSAGES) == [message.ID for message in EVERY_KIND]


def test_every_kind_is_taken_as_sent():
    as_sent = (BOOT, *COUNTED, CELLS, WHEEL, END)  # a board that starts says so first
    readings, state = admitted(*as_sent)
    assert taken(readings) == tuple(type(m).decode(m.encode().data) for m in EVERY_KIND)
    assert readings.coil == COIL
    assert readings.field == FIELD
    input_crc = crc32(b"".join(message.encode().data for message in as_sent[:-1]))
    counters = [*range(5, 16), *(-1,) * len(TELECOMMANDS)]
    assert state == GateState(counters, input_crc=input_crc, command_crc=crc32(END.encode().data))


@EVERY_MESSAGE
class TestEachMessage:
    def test_is_the_only_one_heard(self, message):
        readings, _ = admitted(message)
        assert [type(one) for one in taken(readings) if one is not None] == [type(message)]

    def test_broken_crc(self, message):
        assert admitted(broken(message.encode())) == (Readings(), GateState(rejected=1))

    @pytest.mark.parametrize("change", [lambda d: d[:-1], lambda d: d + b"\0", lambda d: b""])
    def test_wrong_length(self, message, change):
        frame = message.encode()
        assert admitted(frame.replace(data=change(frame.data))) == (Readings(), GateState(rejected=1))

    @pytest.mark.parametrize("flag", [EXTENDED_FLAG, REMOTE_FLAG, ERROR_FLAG])
    def test_flagged_frames_are_never_ours(self, message, flag):
        frame = message.encode()
        flagged = frame.replace(can_id=frame.can_id | flag)
        assert admitted(flagged) == (Readings(), GateState(rejected=1))

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
            readings, state = admitted(message.replace(counter=counter))
            assert readings != Readings()
            assert (state.rejected, state.missed) == (0, 0)

    def test_forty_in_order_miss_nothing(self, message):
        state = GateState()
        for counter in range(40):
            readings, state = admitted(message.replace(counter=counter), state=state)
            assert readings != Readings()
        assert (state.rejected, state.missed) == (0, 0)

    def test_the_last_of_several_counts(self, message):
        readings, _ = admitted(*(message.replace(counter=n) for n in (3, 4, 5)))
        assert taken(readings)[SLOT[message.ID]].counter == 5


def test_every_refusal_of_a_tick_is_taken():
    """The board sends one for each request; those of another sender must not hide the own one."""
    sent = tuple(REFUSED.replace(seq=n, counter=n) for n in range(9))
    assert admitted(*sent)[0].refused == sent


def test_no_more_refusals_are_taken_than_frames_are_read():
    sent = [REFUSED.replace(seq=n, counter=n % 16) for n in range(100)]
    readings, state = admitted(*sent)
    assert len(readings.refused) == INBOX_LIMIT
    assert state.overrun == 100 - INBOX_LIMIT

    def test_a_broken_one_does_not_displace_a_good_one(self, message):
        readings, _ = admitted(message.replace(counter=3), broken(message.replace(counter=4).encode()))
        assert taken(readings)[SLOT[message.ID]].counter == 3

    def test_the_counters_of_others_do_not_move(self, message):
        _, state = admitted(*EVERY_KIND)
        _, later = admitted(message.replace(counter=message.counter + 1), state=state)
        changed = [a != b for a, b in zip(state.counters, later.counters, strict=True)]
        assert changed == [can_id == message.ID for can_id in (*INPUT_MESSAGES, *TELECOMMANDS)]


@EVERY_COUNTED
class TestEachCounter:
    def test_repeated(self, message):
        readings, state = admitted(message, message)
        assert taken(readings)[SLOT[message.ID]] is not None
        assert (state.rejected, state.missed) == (1, 0)

    @pytest.mark.parametrize("counter", [0, 5, 15])
    def test_repeated_in_the_next_tick(self, message, counter):
        _, state = admitted(message.replace(counter=counter))
        readings, state = admitted(message.replace(counter=counter), state=state)
        assert readings == Readings()
        assert (state.rejected, state.missed) == (1, 0)

    @pytest.mark.parametrize("first", [0, 13])
    @pytest.mark.parametrize("jump", range(1, 16))
    def test_a_jump_is_taken_and_what_is_missing_counted(self, message, first, jump):
        _, state = admitted(message.replace(counter=first))
        readings, state = admitted(message.replace(counter=first + jump), state=state)
        assert readings != Readings()
        assert (state.rejected, state.missed) == (0, jump - 1)

    def test_a_broken_frame_does_not_move_the_counter(self, message):
        """What was rejected is missed when the next one comes."""
        _, state = admitted(message.replace(counter=1))
        _, state = admitted(broken(message.replace(counter=2).encode()), state=state)
        _, state = admitted(message.replace(counter=3), state=state)
        assert (state.rejected, state.missed) == (1, 1)


class TestBoot:
    """A board that starts counts anew: its first word is news whatever its counter, and none was missed."""

    @pytest.mark.parametrize("before", [0, 7, 15])
    @pytest.mark.parametrize("counter", range(16))
    def test_is_taken_whatever_was_heard_before(self, before, counter):
        _, state = admitted(BOOT.replace(counter=before))
        readings, state = admitted(BOOT.replace(counter=counter), state=state)
        assert readings.coil_boot == BOOT.replace(counter=counter)
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
        assert admitted(broken(BOOT.encode())) == (Readings(), GateState(rejected=1))


class TestRange:
    @pytest.mark.parametrize("level", range(-8, 8))
    def test_levels_of_a_coil(self, level):
        readings, state = admitted(COIL.replace(level=level))
        assert (readings.coil is not None) is (-3 <= level <= 3)
        assert state.rejected == (not -3 <= level <= 3)

    @pytest.mark.parametrize("coil", range(4))
    def test_there_is_no_fourth_coil(self, coil):
        readings, state = admitted(COIL.replace(coil=coil))
        assert (readings.coil is not None) is (coil < 3)
        assert state.rejected == (coil == 3)

    @pytest.mark.parametrize(
        ("length", "plausible"), [(0.88, False), (0.91, True), (1.0, True), (1.09, True), (1.11, False)]
    )
    def test_a_direction_is_nearly_a_unit_vector(self, length, plausible):
        sun = SUN.replace(s_x=0.6 * length, s_y=-0.48 * length, s_z=0.64 * length)
        readings, state = admitted(sun)
        assert (readings.sun is not None) is plausible
        assert state.rejected == (not plausible)

    def test_a_sun_sensor_that_sees_nothing_may_say_zero(self):
        readings, _ = admitted(SunVector(0, 0.0, 0.0, 0.0))
        assert readings.sun == SunVector(0, 0.0, 0.0, 0.0)

    @pytest.mark.parametrize(
        ("vector", "plausible"),
        [((0.6, -0.48, 0.64), True), ((0.999985, 0.0, 0.0), True), ((0.6, -0.48, 0.66), False)],
    )
    def test_a_reference_attitude_is_a_rotation(self, vector, plausible):
        """The vector part of a unit quaternion is no longer than one, up to the wire's rounding."""
        readings, state = admitted(RefAttitude(1, *vector))
        assert (readings.ref_attitude is not None) is plausible
        assert state.rejected == (not plausible)


class TestTheRest:
    @pytest.mark.parametrize("can_id", [0x000, 0x001, 0x111, 0x7FF, EXTENDED_FLAG, EXTENDED_FLAG | 0x110])
    def test_unknown_identifiers_are_counted(self, can_id):
        assert admitted(Frame(can_id, bytes(8))) == (Readings(), GateState(rejected=1))

    @pytest.mark.parametrize(
        "message",
        [
            PlantBoot(0, 1, 2),
            MagBoot(0, 1, 2),
            CoilHeartbeat(0, 0, 0, 60),
        ],
    )
    def test_what_is_meant_for_others_passes_uncounted(self, message):
        assert admitted(message) == (Readings(), GateState())

    def test_of_whole_frames_under_own_identifiers_the_lowest_is_told(self):
        rate, quality = NavRate(1, 0.0, 0.0, 0.0), NavQuality(0, 0.0, 0.0, 0, 0, 0, 0, 0, 0, 0)
        readings, state = admitted(quality, rate, quality, TickDone(1, 2))
        assert readings == Readings(under_own_id=NavRate.ID)
        assert state == GateState()
        assert admitted(broken(rate.encode())) == (Readings(), GateState(rejected=1))

    @pytest.mark.parametrize(
        "frame",
        [
            broken(PlantBoot(0, 1, 2).encode()),
            Frame(CoilHeartbeat.ID, b"\x01\x02"),
            Frame(Sync.ID, bytes(7)),
        ],
    )
    def test_what_is_broken_is_counted_whoever_it_was_meant_for(self, frame):
        assert admitted(frame) == (Readings(), GateState(rejected=1))


class TestOverrun:
    def test_a_babbling_node_costs_no_more_than_the_limit(self):
        flood = tuple(FIELD.replace(counter=n).encode() for n in range(INBOX_LIMIT + 9))
        readings, state = admitted(*flood)
        assert readings.field.counter == (INBOX_LIMIT - 1) % 16
        assert (state.overrun, state.rejected, state.missed) == (9, 0, 0)

    def test_exactly_the_limit_is_no_overrun(self):
        _, state = admitted(*[FIELD.replace(counter=n) for n in range(INBOX_LIMIT)])
        assert state.overrun == 0

    def test_what_lies_beyond_the_limit_is_not_read(self):
        noise = (Frame(0x7FF, b""),) * INBOX_LIMIT
        readings, state = admitted(*noise, FIELD)
        assert readings == Readings()
        assert (state.rejected, state.overrun) == (INBOX_LIMIT, 1)


class TestSkipped:
    """The frames of many ticks whose SYNCs were lost: those of now are the last."""

    def test_the_latest_are_read(self):
        many = [FIELD.replace(b_x=2.0 * n, counter=n % 16) for n in range(INBOX_LIMIT + 9)]
        readings, state = admitted(*many, skipped=True)
        assert readings.field == many[-1]
        assert (state.overrun, state.rejected) == (9, 0)
        assert admitted(*many)[0].field == many[INBOX_LIMIT - 1]

    @pytest.mark.parametrize("number", [1, INBOX_LIMIT - 1, INBOX_LIMIT])
    def test_where_they_fit_it_is_all_the_same(self, number):
        few = frames(*[FIELD.replace(counter=n % 16) for n in range(number)])
        assert admitted(*few, skipped=True) == admitted(*few)

    def test_telecommands_are_read_wherever_they_stand_and_in_their_order(self):
        told = [TcFreeze(1, 3), TcFreeze(0, 4), TcFreeze(1, 5)]
        many = [FIELD.replace(counter=n % 16) for n in range(INBOX_LIMIT)]
        inbox = frames(told[0], *many[:20], told[1], *many, told[2])
        readings, state = admitted(*inbox, skipped=True)
        assert readings.telecommands == tuple(told)
        assert state.overrun == len(inbox) - INBOX_LIMIT - 2

    def test_a_babbling_node_costs_no_more_than_two_limits(self):
        flood = frames(*[TcFreeze(1, n % 16) for n in range(5 * INBOX_LIMIT)])
        readings, state = admitted(*flood, skipped=True)
        assert len(readings.telecommands) == 2 * INBOX_LIMIT
        assert state.overrun == 3 * INBOX_LIMIT, "counted"

    def test_in_noise_none_is_believed(self):
        many = [FIELD.replace(counter=n % 16).encode() for n in range(INBOX_LIMIT)]
        many[-NOISE_LIMIT - 1 :] = [broken(FIELD.encode())] * (NOISE_LIMIT + 1)
        readings, _ = admitted(TcFreeze(1, 3), *many, skipped=True)
        assert readings.telecommands == ()


class TestNoise:
    """Frames of chance, some of which pass the CRC: a sample of them does little harm, a telecommand much."""

    COMMAND = TcFreeze(1, 3)

    @pytest.mark.parametrize(
        "noise", [broken(FIELD.encode()), Frame(0x7FF, b""), broken(TcFreeze(1, 2).encode())]
    )
    def test_up_to_the_limit_a_telecommand_is_believed(self, noise):
        around = [self.COMMAND.encode(), *[noise] * NOISE_LIMIT]
        for inbox in (around, around[::-1]):
            readings, state = admitted(*inbox)
            assert readings.telecommands == (self.COMMAND,)
            assert state.rejected == NOISE_LIMIT

    @pytest.mark.parametrize(
        "noise", [broken(FIELD.encode()), Frame(0x7FF, b""), broken(TcFreeze(1, 2).encode())]
    )
    def test_beyond_it_is_dropped_and_counted_wherever_it_stands_and_may_be_sent_again(self, noise):
        around = [self.COMMAND.encode(), *[noise] * (NOISE_LIMIT + 1)]
        for inbox in (around, around[::-1]):
            readings, state = admitted(*inbox)
            assert (readings.telecommands, readings.repeated) == ((), ())
            assert state == GateState(rejected=NOISE_LIMIT + 2)
            again, _ = admitted(self.COMMAND, state=state)
            assert again.telecommands == (self.COMMAND,)

    def test_samples_are_taken_all_the_same(self):
        """Each is judged by its value, and by the ones before."""
        noise = [broken(SUN.encode())] * (NOISE_LIMIT + 1)
        readings, _ = admitted(*noise, FIELD)
        assert readings.field == FIELD

    def test_whole_frames_are_no_noise(self):
        whole = [FIELD.replace(counter=n).encode() for n in range(INBOX_LIMIT - 1)]
        readings, _ = admitted(*whole, self.COMMAND)
        assert readings.telecommands == (self.COMMAND,)
