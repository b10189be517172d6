"""The response in a recorded bench log, level by level, and what it cannot tell."""

import os
from dataclasses import replace

import numpy as np
import pytest

from sim.commissioning.phasing.bench_log import Recording, bench_responses, read_recording
from sim.commissioning.phasing.bench_words import INCONCLUSIVE, findings, lines
from sim.commissioning.phasing.command import of_csv
from sim.errors import HarnessError


@pytest.fixture(scope="module")
def responses(bench_csv):
    return {one.name: one for one in bench_responses(read_recording(bench_csv))}


def test_size_by_level_within_its_uncertainty(responses):
    steps = responses["mag1"].steps
    assert [step.command_am2 for step in steps] == [(m, 0.0, 0.0) for m in (0.01, 0.02, 0.04, 0.08)]
    for step in steps:
        m = step.command_am2[0]
        expected = np.array([3e5, -5e5, 5e5]) * m
        assert (np.abs(step.response_nt - expected) < 4.0 * step.sigma_nt + 50.0).all()
    assert [step.edges for step in steps] == [6, 5, 4, 4]


def test_phase_is_between_the_last_sample_without_it_and_the_first_with_it(responses):
    strong = responses["mag1"].steps[-1]
    assert strong.changed_s == pytest.approx(0.19, abs=1e-6)
    assert strong.unchanged_s == 0.0


def late(bench_csv, path, by_s):
    """The same log, whose commands are logged so long before they act."""

    def moved(line):
        t_s, channel, *rest = line.split(",")
        return ",".join([f"{float(t_s) - by_s:.4f}" if channel == "cmd" else t_s, channel, *rest])

    head, *rows = bench_csv.read_text().splitlines()
    path.write_text("\n".join([head, *map(moved, rows)]) + "\n")
    return {one.name: one for one in bench_responses(read_recording(path))}


def test_rows_that_are_doubled_do_not_make_a_response_late(bench_csv, responses, tmp_path):
    head, *rows = bench_csv.read_text().splitlines()
    path = tmp_path / "doubled.csv"
    path.write_text("\n".join([head, *(row for row in rows for _ in range(2))]) + "\n")
    for doubled in bench_responses(read_recording(path)):
        assert findings(doubled) == findings(responses[doubled.name])


def test_a_response_that_is_late_is_told_and_its_size_is_as_without_the_delay(bench_csv, responses, tmp_path):
    found = late(bench_csv, tmp_path / "late.csv", 1.6)
    assert "late: 1.59 to 1.79 s after the command, with a reading every 0.20 s" in findings(found["mag1"])
    assert not any("in phase" in text for text in findings(found["mag1"]))
    assert max(found["mag1"].noise_nt) < 400.0, "of readings that are settled"
    for step, other in zip(found["mag1"].steps, responses["mag1"].steps, strict=True):
        assert (np.abs(step.response_nt - other.response_nt) < 4.0 * (step.sigma_nt + other.sigma_nt)).all()
    assert "in phase with the command, within 0.19 s; the log tells it no closer" in findings(
        responses["mag1"]
    )


def test_noise_of_a_few_nanotesla_is_told_as_such(responses):
    one = responses["mag1"]
    quiet = replace(
        one,
        noise_nt=np.array([20.0, 31.0, 4.0]),
        steps=[replace(step, sigma_nt=np.array([2.0, 3.0, 1.0])) for step in one.steps],
    )
    head, *rows = lines([quiet])
    assert head.startswith("mag1: noise 0.020 0.031 0.004 uT")
    assert all("±0.002 " in row and "±0.003 " in row for row in rows if "edges" in row)


def without_a_command(text):
    head, *rows = text.splitlines()
    idle = [row.rsplit(",", 3)[0] + ",0,0,0" if ",cmd," in row else row for row in rows]
    return "\n".join([head, *idle]) + "\n"


def with_a_dead_magnetometer(text):
    head, *rows = text.splitlines()
    dead = [
        row if ",cmd," in row else ",".join([*row.split(",")[:2], "1000", "1000", "1000,,,"]) for row in rows
    ]
    return "\n".join([head, *dead]) + "\n"


def without_a_zero(text):
    head, *rows = text.splitlines()
    return "\n".join([head, *(row.replace("0.000000,0.000000", "0.001,0") for row in rows)]) + "\n"


def of_two_rows(text):
    head, reading, *rows = text.splitlines()
    return "\n".join([head, reading, reading.replace("mag1", "mag2"), rows[1]]) + "\n"


@pytest.mark.parametrize(
    ("change", "code"),
    [(str, 0), (without_a_command, 1), (with_a_dead_magnetometer, 1), (of_two_rows, 1), (without_a_zero, 1)],
)
def test_a_log_in_which_nothing_responds_has_failed(bench_csv, tmp_path, change, code):
    path = tmp_path / "bench.csv"
    path.write_text(change(bench_csv.read_text()))
    found = of_csv(path)
    assert found.ok is not bool(code)
    out = str(found)
    assert out.count("responds to no command") + out.count("nothing to compare") == 2 * code


def test_an_axis_that_repeats_another_is_told(responses):
    assert responses["mag1"].tied == ("z = -y",)


def test_a_response_out_of_proportion_is_told(responses):
    assert any("not proportional to a command along x" in text for text in findings(responses["mag2"]))
    assert not any("not proportional" in text for text in findings(responses["mag1"]))


def of_levels(*fields_by_level):
    """A recording of a command along x whose response has these sizes, by level, after a rest each."""
    times, readings, commands = [], [], []
    for number, (level, field_nt) in enumerate(pair for one in fields_by_level for pair in ((0.0, 0.0), one)):
        commands.append((4.0 * number, level))
        times += [4.0 * number + 0.25 * part for part in range(1, 16)]
        readings += [20000.0 + field_nt + 10.0 * (part % 2) for part in range(1, 16)]
    moments, levels = np.array(commands).T
    x, still = np.array(readings), np.zeros(len(readings))
    fields = {"mag": (np.array(times), np.column_stack([x, 500.0 + still, -2.0 * x]))}
    return Recording(fields, (moments, np.outer(levels, (1.0, 0.0, 0.0))))


BOTH_SENSES = ((0.1, 5e3), (-0.1, -5e3), (0.2, 1e4), (-0.2, -1e4))


@pytest.mark.parametrize(
    ("levels", "axes"),
    [
        (BOTH_SENSES, []),
        (tuple((level, -field_nt) for level, field_nt in BOTH_SENSES), []),
        (((0.1, 5e3), (0.2, -1e4)), ["x", "z"]),
        (((-0.1, 5e3), (-0.2, -1e4), (0.1, 5e3)), ["x", "z"]),
    ],
)
def test_a_response_reverses_with_the_level_of_one_sense_of_a_command(levels, axes):
    (found,) = bench_responses(of_levels(*levels))
    told = [text for text in findings(found) if "reverses" in text]
    assert told == [f"the response of {axis} to a command along x reverses with its level" for axis in axes]


def test_no_axis_is_claimed(responses):
    assert lines(list(responses.values()))[-1] == INCONCLUSIVE


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda text: text.replace("mag_y_nt", "mag_why"), "column mag_y_nt is missing"),
        (lambda text: text.replace("cmd_z_am2", "cmd_z_am2,mag_x_nt", 1), "there are two columns 'mag_x_nt'"),
        (lambda text: text.replace(",mag1,20000", ",mag1,twenty", 1), "line 2: mag_x_nt is 'twenty'"),
        (lambda text: text.replace(",cmd,", ",other,"), "is"),
        (lambda text: text.splitlines()[0] + "\n", "no commands"),
        (
            lambda text: text.replace(",mag1,20000", ",mag1,1e300", 1),
            r"line 2: mag_x_nt is 1e\+300, beyond 1e\+12",
        ),
        (lambda text: text.replace("\n100.0000,", "\n-1e15,", 1), r"line 2: log_time_s is -1e\+15, beyond"),
        (lambda text: text + "180.1", r"line 1202: channel is missing"),
        (lambda text: text + "180.1,", r"line 1202: channel is missing"),
        (lambda text: text + "180.1,mag1,20000", r"line 1202: mag_y_nt is None, which is no number"),
    ],
)
def test_a_broken_file_is_told_in_a_sentence(bench_csv, tmp_path, change, says):
    path = tmp_path / "broken.csv"
    path.write_text(change(bench_csv.read_text()))
    with pytest.raises(HarnessError, match=says):
        read_recording(path)


def test_a_file_from_a_spreadsheet_is_read_alike(bench_csv, responses, tmp_path):
    path = tmp_path / "excel.csv"
    path.write_bytes(b"\xef\xbb\xbf" + bench_csv.read_bytes().replace(b"\n", b"\r\n"))
    for found in bench_responses(read_recording(path)):
        assert lines([found]) == lines([responses[found.name]])


def test_a_pipe_is_refused_before_it_is_opened(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    with pytest.raises(HarnessError, match=r"pipe\.csv: cannot be read: it is no regular file"):
        read_recording(tmp_path / "pipe.csv")


def test_a_file_that_is_not_there_is_told_in_a_sentence(tmp_path):
    with pytest.raises(HarnessError, match=r"none\.csv: cannot be read: No such file"):
        read_recording(tmp_path / "none.csv")
