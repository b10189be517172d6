"""A run that was cut, altered or is of another version: ``replay`` and ``check`` say so, whatever it is."""

import json
import resource
import shutil

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fsw.wire.messages import CoilBoot
from sim.audit.check import CONTRACT_VERSION
from sim.record.log_index import index_path

TINY = ("microsat", "--seed", "7", "--orbits", "0.005", "--bus", "virtual")
COMMANDS = (("replay",), ("replay", "--plant"), ("check",))
FEW = settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))


@pytest.fixture
def run(sil_run, tmp_path):
    """A copy of a run of 30 ticks, to be altered."""
    return shutil.copytree(sil_run(*TINY), tmp_path / "run")


def judged(torquer, run):
    """Every command's outcome; none has ended with a traceback."""
    for command, *options in COMMANDS:
        done = torquer(command, run, *options)
        assert done.code in (0, 1, 2)
        assert "Traceback" not in done.out + done.err
        yield done


@pytest.mark.long
def test_as_flown_all_is_well(run, torquer):
    for done in judged(torquer, run):
        assert (done.code, done.err) == (0, "")
        assert "index" not in done.out


@pytest.mark.long
@pytest.mark.parametrize("name", ["bus.log", "bus.log.index"])
def test_cut_at_any_byte(run, torquer, name):
    whole = (run / name).read_bytes()

    @FEW
    @given(st.integers(0, len(whole) - 1))
    def cut(size):
        (run / name).write_bytes(whole[:size])
        for done in judged(torquer, run):
            assert done.code != 0
            assert any(word in done.out + done.err for word in ("index", "line 1", "empty"))

    cut()


@pytest.mark.long
@pytest.mark.parametrize("name", ["bus.log", "bus.log.index"])
def test_any_bit_altered(run, torquer, name):
    whole = (run / name).read_bytes()

    @FEW
    @given(st.integers(0, len(whole) - 1), st.integers(0, 7))
    def flip(place, bit):
        altered = bytearray(whole)
        altered[place] ^= 1 << bit
        (run / name).write_bytes(altered)
        for done in judged(torquer, run):
            assert done.code != 0
            assert "index" in done.out or "altered: " in done.out or "torquer: " in done.err

    flip()


def test_what_no_verdict_depends_on_is_given_away_by_the_index_alone(run, torquer):
    """The channel's name in every line."""
    text = (run / "bus.log").read_text()
    (run / "bus.log").write_text(text.replace(" virtual ", " virtuel "))
    for done in judged(torquer, run):
        assert done.code == 1
        assert "altered: lines " in done.out


def test_a_bare_log_is_judged_and_said_to_be_one(run, torquer):
    index_path(run / "bus.log").unlink()
    for done in judged(torquer, run):
        assert done.code == 0
        assert (
            "note: nothing vouches for the log: there is no bus.log.index beside it" in done.out.splitlines()
        )


# --- of another version


def test_a_run_of_another_version(run, torquer):
    run_json = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps(run_json | {"schema_version": 99}))
    for command in ("replay", "report"):
        done = torquer(command, run)
        assert done.code == 2
        assert "schema_version is 99, and only 1 can be read" in done.sentence


@pytest.mark.parametrize("content", ["[]", "3", "null", '"text"', "{}"])
def test_a_run_json_of_something_else(run, torquer, content):
    (run / "run.json").write_text(content)
    done = torquer("replay", run)
    assert done.code == 2
    assert "run.json: schema_version is None" in done.sentence


def test_a_log_of_another_bus_contract(sil_run, copy_of, torquer):
    copy = copy_of(sil_run(*TINY))
    boots = [index for index in copy.where(CoilBoot) if index >= 0]
    assert all(CoilBoot.decode(copy.entries[index][2].data).version == CONTRACT_VERSION for index in boots)
    copy.change(boots[0], version=CONTRACT_VERSION + 1)
    done = torquer("check", copy.write())
    assert done.code == 2
    assert f"line {boots[0] + 1} is of version {CONTRACT_VERSION + 1} of the bus contract" in done.sentence


# --- no room on the disk

LONGER = ("--seed", "3", "--orbits", "0.1")


def with_files_of_at_most(size):
    return {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))}


@pytest.mark.long
@pytest.mark.parametrize("bus", ["virtual", "loop"])
@pytest.mark.slow
def test_a_full_disk_ends_the_flight_with_what_was_flown_kept(bus, start, tmp_path, torquer, sil_run):
    folder, limit = tmp_path / "run", with_files_of_at_most(180_000)
    words = ("torquer", "sil", "microsat", *LONGER, "--bus", bus, "--out", folder)
    ended = start(*words, **limit).wait()
    assert ended.code == 1
    assert "bus.log: cannot be written at " in ended.err
    assert "the log up to then is kept" in ended.err
    assert "Traceback" not in ended.err
    assert ended.err.count("\n") == (1 if bus == "virtual" else 2), "one sentence of each process"
    whole = sil_run("microsat", *LONGER, "--bus", "virtual")
    logged = (folder / "bus.log").read_text().replace(" loop ", " virtual ")
    assert 170_000 < len((folder / "bus.log").read_bytes()) <= 180_000
    assert (whole / "bus.log").read_text().startswith(logged)
    assert logged.endswith("\n")
    assert json.loads((folder / "run.json").read_text())["complete"] is False
    replayed = torquer("replay", folder)
    assert replayed.code == 1
    assert replayed.out.startswith("bit-exact: ")
    assert "index: bus.log.index has no end mark: the flight did not come to its end" in replayed.out
    checked = torquer("check", folder)
    assert checked.code == 1
    assert checked.out.endswith("FAIL: limits kept as far as the log goes, but it is incomplete\n")
    assert torquer("report", folder).code == 0


@pytest.mark.long
def test_a_disk_too_small_for_the_histories_is_known_before_the_flight(start, tmp_path):
    words = ("torquer", "sil", "microsat", *LONGER, "--bus", "virtual", "--out", tmp_path / "run")
    ended = start(*words, **with_files_of_at_most(100_000)).wait()
    assert ended.code == 2
    assert "truth.h5: histories of this length need 0.2 MB: File too large" in ended.sentence.replace(
        "Error", ""
    )


@pytest.mark.long
@pytest.mark.slow
def test_a_disk_that_is_full_after_the_flight_loses_the_report_alone(start, tmp_path, torquer):
    """The report of a short flight is longer than its log and histories."""
    words = ("torquer", "sil", "microsat", "--orbits", "0.02", "--bus", "virtual")
    ended = start(*words, "--out", tmp_path / "run", **with_files_of_at_most(75_000)).wait()
    assert ended.code == 1
    assert "there is no room to write (File too large)" in ended.sentence
    assert torquer("replay", tmp_path / "run").code == 0
    assert torquer("check", tmp_path / "run").code == 0
