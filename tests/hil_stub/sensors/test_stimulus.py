"""What a sensor on the bench is shown: a constant, a recorded log, a script, lines on a pipe."""

import os

import pytest

from fsw.wire.candump_line import format_line
from fsw.wire.messages import CoilBoot, MagField, SunCells, SunVector, Sync
from hil_stub.process.stimulus_option import PipedStimulus
from hil_stub.sensors.stimulus import (
    NOTHING,
    Reading,
    StimulusError,
    constant,
    currents,
    direction,
    finite_numbers,
    recorded,
    scaled,
    scripted,
)


def line(message):
    return format_line("1427513417.000000", "vcan0", message.encode()).encode()


def from_nt(vector):
    return scaled(vector, 1e-9)


class TestLog:
    def test_each_tick_shows_what_was_said_in_it(self):
        log = [
            line(CoilBoot(0, 1, 0)),
            line(MagField(1, 100.0, -200.0, 300.0)),
            line(SunVector(1, 0.0, 0.5, 0.0)),
            line(Sync(0, 0)),
            line(Sync(1, 1)),
            line(MagField(0, 0.0, 0.0, 2.0)),
            line(Sync(2, 2)),
        ]
        field = recorded(log, MagField, 1e-9)
        assert field(0).numbers == pytest.approx((1e-7, -2e-7, 3e-7))
        assert field(0).valid
        assert field(1) is NOTHING, "it was silent"
        assert field(2) == Reading((0.0, 0.0, 2e-9), False)
        assert field(3) is NOTHING, "the log has ended"
        assert recorded(log, SunVector, 1.0)(0) == Reading((0.0, 0.5, 0.0), True)

    def test_cells_show_all_of_their_currents(self):
        log = [line(SunCells(1, 0.5, 0.25, 0.0, 1.0, 0.125, 1.5)), line(Sync(0, 0))]
        assert recorded(log, SunCells, 1.0)(0) == Reading((0.5, 0.25, 0.0, 1.0, 0.125, 1.5), True)

    def test_broken_frames_and_other_lines_show_nothing(self):
        good = line(MagField(1, 100.0, -200.0, 300.0))
        broken = good.replace(b"#", b"#F", 1)[:-2] + b"\n"
        log = [
            b"",
            b"no frame at all\n",
            b"(0.0) vcan0 110#R\n",
            broken,
            line(Sync(0, 0)),
            good,
            line(Sync(1, 0)),
        ]
        field = recorded(log, MagField, 1e-9)
        assert (field(0), field(1).valid) == (NOTHING, True)

    def test_a_log_without_the_sensor_is_refused(self):
        with pytest.raises(StimulusError, match="holds no MagField"):
            recorded([line(SunVector(1, 0.0, 0.5, 0.0)), line(Sync(0, 0))], MagField, 1e-9)


class TestScript:
    STEPS = (
        {"t_s": 0, "field_nt": [20000, 0, -30000], "sun": [1.0, 0.0, 0.0]},
        {"t_s": 1.5, "sun": False},
        {"t_s": 3.0, "field_nt": [0.0, 5.0, 0.0], "sun": [0.0, 3.0, 4.0]},
    )

    def test_a_step_holds_until_the_next_that_names_the_sensor(self):
        field = scripted(list(self.STEPS), "field_nt", 2, from_nt)
        shown = [field(tick).numbers for tick in (0, 3, 5, 6, 1000)]
        assert shown == [pytest.approx(from_nt((20000.0, 0.0, -30000.0)))] * 3 + [(0.0, 5e-9, 0.0)] * 2

    def test_false_is_nothing_and_a_direction_has_length_one(self):
        sun = scripted(list(self.STEPS), "sun", 2, direction)
        assert [sun(tick).valid for tick in (0, 2, 3, 5, 6)] == [True, True, False, False, True]
        assert sun(6).numbers == (0.0, 0.6, 0.8)

    def test_before_its_first_step_there_is_nothing(self):
        assert scripted([{"t_s": 0.0}, {"t_s": 5.0, "sun": [1, 0, 0]}], "sun", 1, direction)(4) is NOTHING

    @pytest.mark.parametrize(
        ("steps", "named"),
        [
            (None, "step"),
            ([], "step"),
            (["x"], "step 1: t_s"),
            ([{"field_nt": [1, 2, 3]}], "step 1: t_s"),
            ([{"t_s": -1.0}], "step 1: t_s"),
            ([{"t_s": True}], "step 1: t_s"),
            ([{"t_s": float("nan")}], "step 1: t_s"),
            ([{"t_s": 0}, {"t_s": 0}], "step 2: t_s"),
            ([{"t_s": 0, "field_nt": [1, 2]}], "step 1: field_nt"),
            (
                [{"t_s": 0}, {"t_s": 1, "feild_nt": [1, 2, 3]}],
                "step 2: feild_nt is not known: t_s, field_nt, sun",
            ),
            ([{"t_s": 0, "field_nt": True}], "step 1: field_nt"),
            ([{"t_s": 0, "field_nt": [1, 2, float("inf")]}], "step 1: field_nt"),
            ([{"t_s": 0, "field_nt": [1, 2, True]}], "step 1: field_nt"),
        ],
    )
    def test_what_is_wrong_is_named(self, steps, named):
        with pytest.raises(StimulusError, match=named):
            scripted(steps, "field_nt", 1, from_nt)


def test_a_constant_is_there_at_every_tick():
    assert {constant((1.0, 2.0, 3.0))(tick) for tick in (0, 7, 10**9)} == {Reading((1.0, 2.0, 3.0), True)}


def test_finite_numbers_may_be_whole_ones():
    assert finite_numbers([1, 2.5, -3], 3) == (1.0, 2.5, -3.0)


class TestPipe:
    @pytest.fixture
    def pipe(self, monkeypatch):
        monkeypatch.setattr("hil_stub.process.stimulus_option.PIPE_PATIENCE_S", 0.05)
        reading, writing = os.pipe()
        yield PipedStimulus(1e-9, 3, reading), writing
        os.close(reading)

    def test_it_waits_for_its_tick_and_lets_go_of_what_is_past(self, pipe):
        shown, end = pipe
        os.write(end, b"0 1 2 3 1\n1 10.5 -20 30 0\n2 7 7")
        assert shown(0) == Reading(from_nt((1.0, 2.0, 3.0)), True)
        assert shown(1) == Reading(from_nt((10.5, -20.0, 30.0)), False)
        assert shown(2) is NOTHING, "half a line is none"
        os.write(end, b" 7 1\n")
        assert shown(2) == Reading(from_nt((7.0, 7.0, 7.0)), True)
        assert shown(0) is NOTHING
        os.close(end)

    @pytest.mark.parametrize(
        "line",
        [
            b"",
            b"0",
            b"0 1",
            b"0 1 2 3",
            b"0 1 2 3 4 1",
            b"0 1 2 x 1",
            b"0 1 2 nan 1",
            b"-1 1 2 3 1",
            b"1.5 1 2 3 1",
            b"0 1 2 3 2",
            b"\xff\x00",
        ],
    )
    def test_a_line_that_is_no_reading_is_told(self, pipe, line):
        shown, end = pipe
        os.write(end, b"3 1 2 3 1\n" + line + b"\n")
        with pytest.raises(StimulusError, match="a line on stdin must be a tick, three finite numbers and 1"):
            shown(3)
        os.close(end)

    def test_a_line_without_an_end_is_told_before_it_fills_the_memory(self, pipe):
        shown, end = pipe
        os.write(end, b"1" * 300)
        with pytest.raises(StimulusError, match=r"not '1{60}'"):
            shown(0)
        os.close(end)

    def test_a_pipe_that_is_closed_shows_nothing(self, pipe):
        shown, end = pipe
        os.close(end)
        assert shown(0) is NOTHING


class TestCells:
    def test_a_script_gives_six_currents(self):
        steps = [{"t_s": 0.0, "cells": [0.5, 0, 0.25, 0, 1, 0]}, {"t_s": 3.0, "cells": False}]
        shown = scripted(steps, "cells", 2, currents, 6)
        assert shown(5) == Reading((0.5, 0.0, 0.25, 0.0, 1.0, 0.0), True)
        assert shown(6) is NOTHING

    @pytest.mark.parametrize(
        ("given", "reason"),
        [
            ([0.5, 0.1, 0.2], "must be six finite numbers"),
            ([0.5, 0.1, 0.2, 0.0, 0.0, float("nan")], "must be six finite numbers"),
            ([0.5, 0.1, 0.2, 0.0, 0.0, -0.1], "none below 0"),
        ],
    )
    def test_what_is_no_six_currents_is_told(self, given, reason):
        with pytest.raises(StimulusError, match=f"step 1: cells .*{reason}"):
            scripted([{"t_s": 0.0, "cells": given}], "cells", 1, currents, 6)
