"""Files and options that no command can use: one sentence and exit code 2, soon and in little memory."""

import json
import os
import subprocess
import sys

import h5py
import numpy as np
import pytest

from sim.record import run_dir

TINY = ("microsat", "--seed", "7", "--orbits", "0.005", "--bus", "virtual")
LONGEST_S, MOST_MB = 5.0, 500.0
DEEP = 50_000


# --- in a process of its own: what it takes


COMMAND = """
import atexit, sys
from pathlib import Path

def keep_peak():
    told = dict(line.split(":") for line in Path("/proc/self/status").read_text().splitlines())
    Path("peak").write_text(told["VmHWM"].removesuffix("kB"))

atexit.register(keep_peak)
from torquer.cli.main import main
main(sys.argv[1:], prog_name="torquer")
"""
"""Its own peak in kB: what wait4 tells of a child begins with the memory of its parent."""


def measured(*words, cwd):
    """(exit code, stderr) of a command that took less than it may of processor time and memory."""
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *map(str, words)],
        cwd=cwd,
        stdout=subprocess.DEVNULL,
        stderr=(cwd / "stderr").open("w"),
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert used.ru_utime + used.ru_stime < LONGEST_S
    assert int((cwd / "peak").read_text()) / 1024.0 < MOST_MB
    return process.returncode, (cwd / "stderr").read_text()


def deep_list(folder):
    (folder / "x.toml").write_text("a = " + "[" * DEEP + "]" * DEEP)
    return ("sil", "x.toml"), "x.toml: it is nested deeper than 32 levels"


def deep_table(folder):
    (folder / "x.toml").write_text("a = " + "{a = " * DEEP + "1" + "}" * DEEP)
    return ("design", "x.toml"), "x.toml: it is nested deeper than 32 levels"


def deep_key(folder):
    (folder / "x.toml").write_text("a." * DEEP + "a = 1")
    return ("compare", "x.toml"), "x.toml: a key has more than 32 parts"


def deep_setting(folder):
    return ("sil", "--set", "a=" + "[" * DEEP), "--set a: it is nested deeper than 32 levels"


def many_digits(folder):
    (folder / "x.toml").write_text("[time]\ntick_hz = " + "9" * 6000)
    return ("hil", "x.toml"), "x.toml: an integer is not allowed"


def endless_file(folder):
    (folder / "x.toml").symlink_to("/dev/zero")
    return ("sil", "x.toml"), "x.toml: cannot be read (it is no regular file)"


def pipe_that_nobody_writes(folder):
    os.mkfifo(folder / "x.toml")
    return ("sil", "x.toml"), "x.toml: cannot be read (it is no regular file)"


def large_file(folder):
    (folder / "x.toml").touch()
    os.truncate(folder / "x.toml", 10**10)
    return ("sil", "x.toml"), "x.toml: cannot be read (it is larger than 1 MB)"


def large_log(folder):
    (folder / "x.log").touch()
    os.truncate(folder / "x.log", 10**10)
    return ("check", "x.log"), "x.log: not a candump log"


def large_run_json(folder):
    os.truncate(folder / "run" / "run.json", 10**10)
    return ("report", "run"), "run.json: cannot be read (it is larger than 1 MB)"


def rows_without_end(folder):
    """A file of a few kB that declares 10^11 rows of each table."""
    declared = tables(folder)
    with h5py.File(folder / "run" / "truth.h5", "w") as file:
        for name, width in declared:
            shape = (10**11,) if width == 1 else (10**11, width)
            file.create_dataset(name, shape, "f8", chunks=(1024, *shape[1:]))
    return ("report", "run"), "t_s is not stored in one piece in this file"


def rows_that_are_not_there(folder):
    """As many as a run can have, none of them in the file."""
    declared = tables(folder)
    with h5py.File(folder / "run" / "truth.h5", "w") as file:
        for name, width in declared:
            file.create_dataset(name, (2**24,) if width == 1 else (2**24, width), "f8")
    return ("report", "run"), "16777216 rows do not fit into its"


def tables(folder):
    """Name and width of each table of the run's histories."""
    found = []
    with h5py.File(folder / "run" / "truth.h5") as file:
        file.visititems(
            lambda name, item: found.append((name, (*item.shape, 1)[1])) if hasattr(item, "shape") else None
        )
    return found


SAMPLES = (
    deep_list, deep_table, deep_key, deep_setting, many_digits, endless_file, pipe_that_nobody_writes,
    large_file, large_log, large_run_json, rows_without_end, rows_that_are_not_there,
)  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.__name__)
@pytest.mark.usefixtures("run")
def test_it_is_refused_soon_and_in_little_memory(sample, tmp_path):
    words, expected = sample(tmp_path)
    code, output = measured(*words, cwd=tmp_path)
    assert code == 2
    assert output.startswith("torquer: ")
    assert expected in output
    assert output.count("\n") == 1


# --- histories that are none


def replace(run, name, **dataset):
    with h5py.File(run / "truth.h5", "r+") as file:
        del file[name]
        if dataset:
            file.create_dataset(name, **dataset)


@pytest.mark.parametrize(
    "dataset",
    [
        {},
        {"data": "text"},
        {"data": 1.0},
        {"data": ["text"] * 30},
        {"data": np.zeros((30, 3))},
        {"data": np.zeros((30, 4, 2))},
        {"data": np.zeros((29, 4))},
        {"data": np.zeros((30, 4), "f4")},
        {"data": np.zeros((30, 4), "i8")},
        {"data": np.zeros((30, 4), "c16")},
        {"data": np.zeros((30, 4)), "chunks": (10, 4)},
        {"data": np.zeros((30, 4)), "compression": "gzip"},
        {"data": np.full((30, 4), 1e16)},
        {"shape": (0, 4), "dtype": "f8"},
        {"shape": (), "dtype": "f8"},
        {"dtype": h5py.Empty("f8").dtype, "shape": None},
    ],
    ids=str,
)
def test_a_table_of_the_wrong_kind_is_named(run, torquer, dataset):
    replace(run, "q_body_from_orbit", **dataset)
    done = torquer("report", run)
    assert done.code == 2
    assert "truth.h5" in done.sentence
    assert "q_body_from_orbit" in done.sentence


def test_a_group_in_the_place_of_a_table(run, torquer):
    replace(run, "t_s")
    with h5py.File(run / "truth.h5", "r+") as file:
        file.create_group("t_s")
    assert "t_s" in torquer("report", run).sentence


@pytest.mark.parametrize("link", [h5py.SoftLink("/nowhere"), h5py.ExternalLink("other.h5", "/x")], ids=str)
def test_a_table_that_is_elsewhere(run, torquer, link):
    with h5py.File(run / "other.h5", "w") as file:
        file["x"] = np.zeros((30, 4))
    replace(run, "q_body_from_orbit")
    with h5py.File(run / "truth.h5", "r+") as file:
        file["q_body_from_orbit"] = link
    done = torquer("report", run)
    assert done.code == 2
    assert "truth.h5" in done.sentence


@pytest.mark.parametrize("name", ["Coils", "a b", "$\\frac{1}{", "x" * 50])
def test_a_torque_of_a_strange_name(run, torquer, name):
    with h5py.File(run / "truth.h5", "r+") as file:
        file[f"torque_body_nm/{name}"] = np.zeros((30, 3))
    assert "torque_body_nm is no group" in torquer("report", run).sentence


def test_a_hole_in_the_histories_of_a_whole_flight(run, torquer):
    with h5py.File(run / "truth.h5", "r+") as file:
        file["b_body_t"][12, 1] = np.nan
    assert "truth.h5: 12 whole rows, but 30 ticks were flown" in torquer("report", run).sentence


# --- run.json


@pytest.mark.parametrize("command", [("report",), ("replay",), ("replay", "--plant")], ids=" ".join)
@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("ticks", None, "ticks = None is not allowed"),
        ("ticks", "many", "ticks = 'many' is not allowed"),
        ("ticks", 0, "ticks = 0 is not allowed"),
        ("seed", -1, "seed = -1 is not allowed"),
        ("seed", 2**64, "seed = 18446744073709551616 is not allowed"),
        ("pace_factor", "fast", "pace_factor"),
        ("platform", {}, "platform.machine is missing"),
        ("platform", "mine", "platform = 'mine' is not allowed"),
        ("flown", {"ticks": "30"}, "flown.ticks = '30' is not allowed"),
        ("flown", [], "flown = [] is not allowed"),
        ("complete", 1, "complete = 1 is not allowed: allowed is true or false"),
        ("schema_version", "1", "schema_version is 1, and only 1 can be read"),
    ],
)
def test_a_key_of_the_wrong_type_is_named(run, torquer, command, key, value, expected):
    content = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**content, key: value}))
    done = torquer(*command[:1], run, *command[1:])
    assert done.code == 2
    assert "run.json: " in done.sentence
    assert expected in done.sentence


@pytest.mark.parametrize("command", ["check", "report", "replay"])
def test_a_complete_run_without_its_outcome_contradicts_itself(run, torquer, command):
    content = json.loads((run / "run.json").read_text())
    del content["flown"]
    (run / "run.json").write_text(json.dumps({**content, "complete": True}))
    done = torquer(command, run)
    assert done.code == 2
    assert "run.json: complete is true, but flown, which every complete run has, is missing" in done.sentence


@pytest.mark.long
def test_keys_of_a_later_version_are_kept(run, torquer):
    content = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**content, "weather": {"sky": "clear"}, "complete": False}))
    assert torquer("report", run).code == 0
    now = run_dir.read_run(run)
    assert (now["weather"], now["complete"]) == ({"sky": "clear"}, True)


# --- names


@pytest.mark.parametrize(
    "words",
    [
        ("sil", "a\0b"),
        ("sil", "a\0b.toml"),
        ("sil", "--out", "a\0b"),
        ("sil", "--set", "name=a\0b"),
        ("check", "a\0b"),
        ("hil", "--stimulus", "a\0b"),
        ("validate", "--reference", "a\0b"),
        ("a\0b",),
    ],
)
def test_a_nul_in_a_name(words, torquer):
    done = torquer(*words)
    assert done.code == 2
    assert "NUL" in done.sentence or "\\x00" in done.sentence
    assert "\0" not in done.sentence


LONG = "x" * 5000


@pytest.mark.parametrize(
    "words",
    [
        ("sil", LONG),
        ("sil", f"{LONG}.toml"),
        ("sil", "--out", LONG),
        ("design", "microsat", "--json", "--out", LONG),
        ("check", LONG),
        ("replay", LONG),
        ("report", LONG),
        ("validate", "--reference", LONG),
        ("validate", "--quick", "--out", LONG),
        ("faults", "--out", LONG),
        ("validate", "--flight-data", LONG),
        ("watch", LONG),
        ("watch", f"{LONG}/bus.log"),
        ("compare", "microsat", "--out", LONG),
        ("campaign", LONG),
        ("phasing", LONG),
        ("phasing", f"{LONG}.toml"),
        ("calibrate", LONG),
        ("check", "a\nb\x1b[31m"),
    ],
    ids=lambda words: " ".join(words)[:40],
)
def test_a_name_that_no_file_can_have(words, torquer):
    done = torquer(*words)
    assert done.code == 2
    assert len(done.sentence) < 1100
    assert done.sentence.isprintable()


# --- numbers that a flight cannot be flown with


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("time.epoch_utc=2100-01-01T00:00:00Z", "IGRF-14 holds from 2015 to 2030"),
        ("plant.max_substep_s=1e-15", "plant.max_substep_s"),
        ("coils.pulse_s=1e-12", "pulse"),
        ("initial.rate_degps=[1e30, 0, 0]", "--set initial.rate_degps: value.0 is not allowed"),
    ],
)
def test_what_cannot_be_flown_is_refused_before_a_run_is_begun(setting, expected, torquer, tmp_path):
    done = torquer("sil", *TINY[:-2], "--bus", "virtual", "--set", setting, "--out", tmp_path / "new")
    assert done.code == 2
    assert expected in done.sentence
    assert not (tmp_path / "new").exists()


def test_a_motion_that_is_lost_ends_the_flight_in_one_sentence(torquer, tmp_path):
    words = ("--set", "initial.rate_degps=[1e14, 1e13, 0]", "--out", tmp_path / "new")
    done = torquer("sil", *TINY, *words)
    assert done.code == 1
    assert "the motion diverges in tick 0" in done.sentence
    assert torquer("check", tmp_path / "new").code == 1
