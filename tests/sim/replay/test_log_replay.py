"""Replay: an unaltered log is exact; a changed byte, a missing frame or a cut is reported where it is."""

from dataclasses import replace

import pytest

from fsw.core.packing import copy_state
from fsw.table.config import flight_config
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilFire,
    CoilHeartbeat,
    CoilStatus,
    FswBoot,
    MagField,
    NavAttitude,
    NavParameter,
    NavRate,
    PlantEnd,
    SunVector,
    Sync,
    TickDone,
)
from sim.record.candump import LogError, read_log
from sim.record.run_dir import BUS_LOG
from sim.replay.log_replay import replay
from sim.scenario.schema import flight_table, load

TICKS = 300


@pytest.fixture(scope="module")
def entries(recorded_run):
    return list(read_log(recorded_run / BUS_LOG))


@pytest.fixture(scope="module")
def config(recorded_run, config_of):
    return config_of(recorded_run)


@pytest.fixture
def replay_entries(tmp_path, config):
    """Replays entries as a log of their own."""

    def of(entries, config=config):
        log = tmp_path / "bus.log"
        lines = [format_line(format_time(e.timestamp_us), e.channel, e.frame) for e in entries]
        log.write_text("".join(lines))
        return replay(log, config)

    return of


def index_of(entries, kind, tick):
    """Where the tick's frame of a kind is in the log."""
    tick_so_far = -1
    for index, entry in enumerate(entries):
        if entry.frame.can_id == Sync.ID:
            tick_so_far = Sync.decode(entry.frame.data).tick
        before_sync = kind.ID in (MagField.ID, SunVector.ID, CoilStatus.ID, Sync.ID)
        if entry.frame.can_id == kind.ID and (tick_so_far + before_sync - (kind is Sync)) == tick:
            return index
    raise AssertionError(f"no {kind.__name__} in tick {tick}")


def changed(entries, index, change):
    entry = entries[index]
    return [*entries[:index], entry._replace(frame=change(entry.frame)), *entries[index + 1 :]]


def flip(byte, bit=0):
    def change(frame):
        data = bytearray(frame.data)
        data[byte] ^= 1 << bit
        return frame.replace(data=bytes(data))

    return change


class TestUnaltered:
    def test_an_unaltered_log_is_bit_exact(self, recorded_run, config, entries):
        result = replay(recorded_run / BUS_LOG, config)
        assert result.bit_exact
        assert result.command_exact
        assert (result.ticks, result.last_tick) == (TICKS, TICKS - 1)
        assert (result.ended, result.cut, result.end_line) == (True, False, len(entries))
        from_fsw = {FswBoot.ID, CoilFire.ID, TickDone.ID, *range(0x200, 0x204), 0x410, 0x610}
        assert result.frames == sum(entry.frame.can_id in from_fsw for entry in entries)

    def test_there_was_something_to_replay(self, entries):
        assert sum(entry.frame.can_id == CoilFire.ID for entry in entries) >= 2

    def test_the_state_of_every_tick_is_handed_out(self, recorded_run, config):
        states = []
        replay(recorded_run / BUS_LOG, config, lambda state: states.append(copy_state(state)))
        assert [state.tick for state in states] == list(range(TICKS))
        assert states[-1].estimator.estimate is not None

    def test_the_channel_s_name_and_the_time_do_not_count(self, replay_entries, entries):
        renamed = [entry._replace(channel="can7", timestamp_us=entry.timestamp_us + 5) for entry in entries]
        assert replay_entries(renamed).bit_exact

    def test_another_run_of_the_same_seed_gives_the_same_log(self, fly_run, recorded_run):
        assert (fly_run() / BUS_LOG).read_bytes() == (recorded_run / BUS_LOG).read_bytes()

    def test_another_seed_does_not(self, fly_run, recorded_run):
        assert (fly_run(seed=6) / BUS_LOG).read_bytes() != (recorded_run / BUS_LOG).read_bytes()


class TestChangedByte:
    @pytest.mark.parametrize("tick", [0, 1, 57, 150, 299])
    @pytest.mark.parametrize("byte", range(8))
    def test_of_a_field_sample_is_found_in_its_tick(self, replay_entries, entries, tick, byte):
        result = replay_entries(changed(entries, index_of(entries, MagField, tick), flip(byte)))
        assert not result.bit_exact
        assert result.first_bit_difference.tick == tick
        assert str(result.first_bit_difference).startswith(f"tick {tick}: ")
        assert result.first_bit_difference.signal.partition(".")[0] in (
            "NAV_ATTITUDE",
            "NAV_RATE",
            "NAV_QUALITY",
            "NAV_PARAMETER",
            "TICK_DONE",
            "the next frame",
        )

    @pytest.mark.parametrize("kind", [MagField, SunVector, CoilStatus], ids=lambda kind: kind.__name__)
    def test_of_any_board_is_found(self, replay_entries, entries, kind):
        result = replay_entries(changed(entries, index_of(entries, kind, 120), flip(1, 3)))
        assert result.first_bit_difference.tick == 120

    def test_of_a_sample_that_is_not_used_is_found_by_the_checksum(self, replay_entries, entries):
        """The filter is blanked during a pulse: nothing but a counter in the state tells."""
        pulse = next(
            i
            for i, e in enumerate(entries)
            if e.frame.can_id == CoilStatus.ID and CoilStatus.decode(e.frame.data).level
        )
        field = max(i for i in range(pulse) if entries[i].frame.can_id == MagField.ID)
        result = replay_entries(changed(entries, field, flip(2)))
        assert result.first_bit_difference.signal == "TICK_DONE.state_crc"

    def test_of_a_frame_that_fsw_does_not_listen_to_is_found_too(self, replay_entries, entries):
        """The heartbeats of tick 60 stand before fsw's own, which tells the rejects."""
        beat = next(i for i, e in enumerate(entries) if e.frame.can_id == CoilHeartbeat.ID)
        difference = replay_entries(changed(entries, beat, flip(3))).first_bit_difference
        assert (difference.tick, difference.signal) == (60, "FSW_HEARTBEAT.rejects")
        assert (difference.logged, difference.replayed) == (0, 1)

    def test_a_forged_sample_with_a_right_crc_is_found(self, replay_entries, entries):
        index = index_of(entries, MagField, 140)
        field = MagField.decode(entries[index].frame.data)
        forged = changed(entries, index, lambda _: field.replace(b_x=field.b_x + 2.0).encode())
        result = replay_entries(forged)
        assert result.first_bit_difference.tick == 140

    def test_of_sync(self, replay_entries, entries):
        result = replay_entries(changed(entries, index_of(entries, Sync, 100), flip(0)))
        assert not result.bit_exact
        assert result.first_bit_difference.tick in (100, 101)


class TestChangedAnswer:
    """A change in an answer itself is reported by its signal, and as one of a command or of a last bit."""

    def test_a_request(self, replay_entries, entries):
        index = next(i for i, e in enumerate(entries) if e.frame.can_id == CoilFire.ID)
        fire = CoilFire.decode(entries[index].frame.data)
        other = -fire.level
        result = replay_entries(changed(entries, index, lambda _: fire.replace(level=other).encode()))
        difference = result.first_command_difference
        assert (difference.signal, difference.logged, difference.replayed) == (
            "COIL_FIRE.level",
            other,
            fire.level,
        )
        assert difference.tick % 256 == fire.tick
        assert not result.bit_exact

    @pytest.mark.parametrize(
        ("kind", "tick", "signal", "unit"),
        [
            (NavAttitude, 133, "q_y", 2.0**-16),
            (NavRate, 133, "w_z", 2.0**-19),
            (NavParameter, 130, "value", 1),
            (NavParameter, 130, "sigma", 1),
        ],
    )
    @pytest.mark.parametrize(("units", "commands"), [(1, True), (-1, True), (2, False), (-50, False)])
    def test_navigation_may_differ_by_one_unit_on_another_machine(
        self, replay_entries, entries, kind, tick, signal, unit, units, commands
    ):
        index = index_of(entries, kind, tick)
        message = kind.decode(entries[index].frame.data)
        moved = message.replace(**{signal: getattr(message, signal) + units * unit})
        result = replay_entries(changed(entries, index, lambda _: moved.encode()))
        assert not result.bit_exact
        assert result.command_exact is commands
        assert result.first_bit_difference.tick == tick
        assert result.first_bit_difference.signal.endswith(f".{signal}")

    def test_a_flag_may_not(self, replay_entries, entries):
        index = index_of(entries, NavAttitude, 133)
        message = NavAttitude.decode(entries[index].frame.data)
        result = replay_entries(
            changed(entries, index, lambda _: message.replace(valid=1 - message.valid).encode())
        )
        assert result.first_command_difference.signal == "NAV_ATTITUDE.valid"

    def test_a_state_crc_is_no_command(self, replay_entries, entries):
        result = replay_entries(changed(entries, index_of(entries, TickDone, 77), flip(6)))
        assert (result.bit_exact, result.command_exact) == (False, True)
        assert (result.first_bit_difference.tick, result.first_bit_difference.signal) == (
            77,
            "TICK_DONE.state_crc",
        )

    def test_the_tick_that_is_answered_is(self, replay_entries, entries):
        result = replay_entries(changed(entries, index_of(entries, TickDone, 77), flip(0)))
        assert result.first_command_difference.signal == "TICK_DONE.tick"

    @pytest.mark.parametrize("byte", [0, 3, 7])
    def test_a_broken_frame_is_named_as_a_whole(self, replay_entries, entries, byte):
        result = replay_entries(changed(entries, index_of(entries, NavRate, 88), flip(byte)))
        assert result.first_command_difference.tick == 88
        assert result.first_command_difference.signal == "NAV_RATE as a whole"

    def test_a_shortened_frame_is_too(self, replay_entries, entries):
        result = replay_entries(
            changed(entries, index_of(entries, TickDone, 88), lambda f: f.replace(data=f.data[:4]))
        )
        assert result.first_command_difference.signal == "TICK_DONE as a whole"


class TestMissingAndExtra:
    def drop(self, entries, index):
        return entries[:index] + entries[index + 1 :]

    @pytest.mark.parametrize("kind", [MagField, SunVector, CoilStatus], ids=lambda kind: kind.__name__)
    def test_a_missing_board_frame(self, replay_entries, entries, kind):
        result = replay_entries(self.drop(entries, index_of(entries, kind, 42)))
        assert result.first_bit_difference.tick == 42

    def test_a_missing_answer(self, replay_entries, entries):
        result = replay_entries(self.drop(entries, index_of(entries, NavRate, 42)))
        difference = result.first_command_difference
        assert (difference.tick, difference.signal) == (42, "the next frame")
        assert (difference.logged, difference.replayed) == ("TICK_DONE", "NAV_RATE")

    def test_the_last_answer_of_all(self, replay_entries, entries):
        last = max(i for i, e in enumerate(entries) if e.frame.can_id == TickDone.ID)
        result = replay_entries(self.drop(entries, last))
        assert (result.first_command_difference.tick, result.first_command_difference.signal) == (
            299,
            "TICK_DONE",
        )

    def test_an_answer_too_many(self, replay_entries, entries):
        index = index_of(entries, TickDone, 42)
        doubled = [*entries[: index + 1], entries[index], *entries[index + 1 :]]
        difference = replay_entries(doubled).first_command_difference
        assert (difference.signal, difference.logged, difference.replayed) == (
            "TICK_DONE",
            "there",
            "missing",
        )

    def test_a_missing_sync(self, replay_entries, entries):
        result = replay_entries(self.drop(entries, index_of(entries, Sync, 42)))
        assert result.first_command_difference is not None
        assert result.first_command_difference.tick in (41, 42)

    def test_a_foreign_frame_in_the_log(self, replay_entries, entries):
        index = index_of(entries, MagField, 42)
        foreign = entries[index]._replace(frame=Frame(0x7FF, b"\x01"))
        difference = replay_entries([*entries[:index], foreign, *entries[index:]]).first_bit_difference
        assert (difference.tick, difference.signal) == (42, "TICK_DONE.state_crc")


class TestOtherTable:
    def test_the_boot_frame_differs(self, recorded_run):
        other = flight_config(flight_table(load("microsat")))
        result = replay(recorded_run / BUS_LOG, other)
        assert not result.bit_exact
        assert (result.first_bit_difference.tick, result.first_bit_difference.signal) == (
            0,
            "FSW_BOOT.table_crc",
        )

    def test_the_answers_differ_under_other_gains(self, recorded_run, config):
        setpoint = config.control.setpoint
        tripled = replace(setpoint, k_a=3.0 * setpoint.k_a)
        stronger = replace(config, control=replace(config.control, setpoint=tripled))
        result = replay(recorded_run / BUS_LOG, stronger)
        assert not result.bit_exact


class TestTruncated:
    def text(self, recorded_run):
        return (recorded_run / BUS_LOG).read_bytes()

    @pytest.mark.parametrize("part", [0.001, 0.1, 0.33, 0.5, 0.77, 0.9, 0.9999])
    def test_a_log_cut_anywhere_is_exact_as_far_as_it_goes(self, tmp_path, recorded_run, config, part):
        text = self.text(recorded_run)
        log = tmp_path / "bus.log"
        log.write_bytes(text[: round(part * len(text))])
        result = replay(log, config)
        assert result.bit_exact
        assert not result.ended
        whole = log.read_bytes().count(b"\n")
        assert result.end_line == whole
        assert result.cut is (not log.read_bytes().endswith(b"\n"))
        assert result.ticks == result.last_tick + 1 < TICKS or part > 0.99

    @pytest.mark.long
    def test_every_cut_inside_three_ticks(self, tmp_path, recorded_run, config):
        lines = self.text(recorded_run).splitlines(keepends=True)
        text = b"".join(lines[:25])
        log = tmp_path / "bus.log"
        for length in range(1, len(text)):
            log.write_bytes(text[:length])
            result = replay(log, config)
            assert result.bit_exact
            assert result.end_line == text[:length].count(b"\n")
            assert result.cut is not text[:length].endswith(b"\n")

    def test_a_log_without_its_end_mark_has_not_ended(self, replay_entries, entries):
        assert entries[-1].frame.can_id == PlantEnd.ID
        result = replay_entries(entries[:-1])
        assert (result.bit_exact, result.ended, result.cut, result.ticks) == (True, False, False, TICKS)

    def test_nor_has_one_whose_end_mark_is_broken(self, replay_entries, entries):
        assert not replay_entries(changed(entries, len(entries) - 1, flip(1))).ended

    def test_nor_one_that_goes_on_after_it(self, replay_entries, entries):
        assert not replay_entries([*entries, entries[1]]).ended

    @pytest.mark.parametrize("content", [b"", b"hello\n", b"\x89HDF\r\n", b"<html>\n"])
    def test_a_file_that_is_no_log_is_named(self, tmp_path, config, content):
        log = tmp_path / "bus.log"
        log.write_bytes(content)
        with pytest.raises(LogError, match="not a candump log") as caught:
            replay(log, config)
        assert str(log) in str(caught.value)
        assert caught.value.exit_code == 2
