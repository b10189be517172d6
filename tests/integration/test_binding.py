"""A log belongs to its run: exchanged, edited or lost files are named by every command, and so is a kill."""

import json
import shutil
import signal
import subprocess
import sys

import pytest

from fsw.wire.messages import MagField
from sim.record.log_index import index_path

TINY = ("microsat", "--seed", "7", "--orbits", "0.005", "--bus", "virtual")
OTHER = (
    "microsat",
    "--seed",
    "8",
    "--orbits",
    "0.005",
    "--bus",
    "virtual",
    "--set",
    "initial.angle_deg=30.0",
)
JUDGES = (("check",), ("replay",), ("replay", "--plant"))
COMMANDS = (*JUDGES, ("report",))
FILES = ("scenario.toml", "bus.log", "truth.h5", "summary.json")


@pytest.fixture
def run(sil_run, tmp_path):
    """A copy of a run of 30 ticks, to be altered."""
    return shutil.copytree(sil_run(*TINY), tmp_path / "run")


def says(torquer, run, *options):
    """What each command says of a run, by its name."""
    return {" ".join(words): torquer(words[0], run, *words[1:], *options) for words in COMMANDS}


def named(done, name):
    """Whether a command has failed, and told of this file."""
    assert done.code == 1, done
    assert "Traceback" not in done.out + done.err
    assert f"{name} is not the run's own: its SHA-256 begins with " in done.out + done.err, done
    return True


def snapshot(run):
    return {path.name: path.read_bytes() for path in run.iterdir()}


# --- exchanged or edited


@pytest.mark.long
def test_the_log_of_another_run_with_its_index(run, sil_run, torquer):
    for name in ("bus.log", "bus.log.index"):
        shutil.copy(sil_run(*OTHER) / name, run / name)
    assert all(named(done, "bus.log") for done in says(torquer, run).values())
    assert torquer("check", run).out.splitlines()[-1].startswith("FAIL: ")
    for words in JUDGES:  # the log alone is held against the run beside it
        assert named(torquer(words[0], run / "bus.log", *words[1:]), "bus.log")


def test_a_back_off_that_was_edited_is_not_audited_by(run, torquer):
    scenario = run / "scenario.toml"
    scenario.write_text(scenario.read_text().replace("backoff_s = 100.0", "backoff_s = 10.0"))
    assert all(named(done, "scenario.toml") for done in says(torquer, run).values())
    checked = torquer("check", run)
    assert "back-off >= 100.000 s shared" in checked.out
    assert "note: judged by the usual limits: scenario.toml is not the run's" in checked.out


@pytest.mark.parametrize("content", ["", "[", "name = 1\n"])
def test_a_scenario_that_can_no_longer_be_read_is_told_as_one_that_was_exchanged(run, torquer, content):
    (run / "scenario.toml").write_text(content)
    assert named(torquer("check", run), "scenario.toml")
    assert named(torquer("report", run), "scenario.toml")
    replayed = torquer("replay", run)
    assert replayed.code == 2
    assert "; scenario.toml is not the run's own: " in replayed.sentence


@pytest.mark.parametrize("name", ["truth.h5", "summary.json"])
def test_histories_and_summary_that_were_edited(run, torquer, name):
    content = bytearray((run / name).read_bytes())
    content[-200] ^= 1
    (run / name).write_bytes(content)
    for words in JUDGES:
        done = torquer(words[0], run, *words[1:])
        assert named(done, name)
        assert any(text in done.out for text in ("limits: pulse", "bit-exact: 30", "plant reproduced: 30"))


@pytest.mark.parametrize("name", FILES[2:])
def test_a_file_that_is_gone(run, torquer, name):
    (run / name).unlink()
    for words in JUDGES:
        done = torquer(words[0], run, *words[1:])
        assert done.code == 1
        assert f"MISMATCH {name} is missing, and run.json has its digest" in done.out.splitlines()


def test_an_altered_frame_is_still_reported_by_tick_and_signal(copy_of, sil_run, torquer):
    copy = copy_of(sil_run(*TINY))
    bound = (copy.folder / "run.json").read_bytes()
    index = copy.in_tick(17, MagField)
    copy.change(index, b_x=MagField.decode(copy.entries[index][2].data).b_x + 100.0)
    copy.write()
    (copy.folder / "run.json").write_bytes(bound)
    replayed = torquer("replay", copy.folder)
    assert named(replayed, "bus.log")
    assert replayed.out.startswith("differs: tick 17: ")
    plant = torquer("replay", copy.folder, "--plant")
    assert named(plant, "bus.log")
    assert plant.out.startswith("differs: tick 17: MAG_FIELD is ")


def test_a_broken_limit_is_still_reported(copy_of, sil_run, torquer):
    from fsw.wire.messages import CoilStatus

    copy = copy_of(sil_run(*TINY))
    bound = (copy.folder / "run.json").read_bytes()
    copy.change(copy.where(CoilStatus)[10], level=2)
    copy.write()
    (copy.folder / "run.json").write_bytes(bound)
    checked = torquer("check", copy.folder)
    assert named(checked, "bus.log")
    assert "VIOLATION t=" in checked.out


# --- report


@pytest.mark.parametrize("name", FILES[:3])
def test_report_rebuilds_nothing_from_what_is_not_the_runs(run, sil_run, torquer, name):
    shutil.copy(sil_run(*OTHER) / name, run / name)
    before = snapshot(run)
    done = torquer("report", run)
    assert named(done, name)
    assert f"torquer: {run}: {name} is not" in done.sentence
    assert snapshot(run) == before


@pytest.mark.long
def test_report_names_an_edited_summary_once_and_rebuilds_it(run, torquer):
    before = snapshot(run)
    (run / "summary.json").write_text(json.dumps({"limits_ok": True}))
    assert named(torquer("report", run), "summary.json")
    assert snapshot(run) | {"report.html": b""} == before | {"report.html": b""}
    assert torquer("report", run).code == 0
    assert torquer("check", run).code == 0


# --- older, or killed


@pytest.mark.long
def test_a_run_of_before_there_were_digests_is_judged_as_it_was(run, torquer):
    run_json = json.loads((run / "run.json").read_text())
    del run_json["digests"]
    (run / "run.json").write_text(json.dumps(run_json))
    (run / "summary.json").write_text((run / "summary.json").read_text() + "\n")
    note = "note: run.json is of an older version: no digests of bus.log, truth.h5, summary.json"
    for _ in range(2):  # report has not bound it
        for done in says(torquer, run).values():
            assert (done.code, done.err) == (0, "")
            assert note in done.out.splitlines()


KILLED_AT_EACH_STEP = """
import os, signal, sys
from pathlib import Path
from sim.flight import sil, virtual
from sim.record import binding, run_dir
from sim.report import conclude
from torquer.cli.main import main

base, words = Path(sys.argv[1]), sys.argv[2:]
conclude.write_report = lambda path, *rest: path.write_text("")
DOINGS = ("open", "os.rename", "os.truncate", "os.remove")

def within(name, folder):
    return isinstance(name, str | os.PathLike) and os.fspath(name).startswith(str(folder))

for step in range(1000):
    folder = base / f"run{step}"
    child = os.fork()
    if not child:
        left = [step]

        def count(event, arguments, folder=folder):
            if event in DOINGS and within(arguments[0], folder):
                if not left[0]:
                    os.kill(os.getpid(), signal.SIGKILL)
                left[0] -= 1

        sys.addaudithook(count)
        sys.stdout = open(os.devnull, "w")
        main.main([*words, "--out", str(folder)], prog_name="torquer")
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    print(step, status, flush=True)
    if status != -signal.SIGKILL:
        break
"""


@pytest.mark.long
@pytest.mark.slow
def test_a_kill_before_any_step_leaves_a_run_that_contradicts_nothing(tmp_path, torquer):
    """Every file that is opened or replaced is a moment to be killed before."""
    words = [sys.executable, "-c", KILLED_AT_EACH_STEP, tmp_path, "sil", *TINY]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    *killed, last = [tuple(map(int, line.split())) for line in done.stdout.splitlines()]
    assert last[1] == 0, done.stderr
    assert {code for _, code in killed} == {-signal.SIGKILL}
    assert len(killed) > 20
    notes = set()
    for step, _ in killed:
        folder = tmp_path / f"run{step}"
        if not (folder / "run.json").exists():
            continue
        log = folder / "bus.log"
        readable = log.exists() and log.stat().st_size
        for command in ("check", "replay"):
            judged = torquer(command, folder)
            assert "MISMATCH" not in judged.out
            assert judged.code in (0, 1) if readable else judged.code == 2, judged
            assert judged.err == "" or judged.sentence
            notes.update(line for line in judged.out.splitlines() if "not finished" in line)
    assert "note: the run was not finished: no digests of bus.log, truth.h5" in notes
    assert "note: the run was not finished: no digests of truth.h5, summary.json" in notes
    assert torquer("check", tmp_path / f"run{last[0]}").code == 0


@pytest.mark.long
def test_a_kill_while_the_summary_is_replaced_leaves_none_that_is_wrong(run, torquer, monkeypatch):
    """As when another version of the program makes another summary of the same flight."""
    from sim.record import run_dir
    from sim.report import conclude

    bound = json.loads((run / "run.json").read_text())
    bound["flown"]["wall_s"] = 1.25
    (run / "run.json").write_text(json.dumps(bound))

    class KilledError(BaseException):
        pass

    def kill(*rest):
        raise KilledError

    with monkeypatch.context() as patch:
        patch.setattr(conclude, "write_report", kill)
        with pytest.raises(KilledError):
            conclude.conclude(run)
    assert json.loads((run / run_dir.SUMMARY).read_text())["wall_seconds"] == 1.25
    for words in JUDGES:
        done = torquer(words[0], run, *words[1:])
        assert done.code == 0
        assert "note: the run was not finished: no digests of summary.json" in done.out
    assert torquer("report", run).code == 0
    assert "note" not in torquer("check", run).out


LOOSE_BENCH = (
    *("hil", "microsat", "--tick-hz", "10", "--seconds", "1"),
    *("--jitter-ms", "1000", "--latency-ms", "1000", "--slips", "15"),
)
"""What is tested is not how busy this machine is."""


@pytest.mark.long
@pytest.mark.slow
def test_the_bench_binds_its_log_and_its_numbers(torquer, tmp_path):
    run = tmp_path / "run"
    assert torquer(*LOOSE_BENCH, "--bus", "loop", "--out", run).err == ""
    assert set(json.loads((run / "run.json").read_text())["digests"]) == {"bus.log", "hil.json"}
    before = torquer("check", run)
    assert "MISMATCH" not in before.out + before.err
    assert "not finished" not in before.out
    (run / "hil.json").write_text("{}")
    assert named(torquer("check", run), "hil.json")
    index_path(run / "bus.log").unlink()
    with (run / "bus.log").open("ab") as log:
        log.write((run / "bus.log").read_bytes().splitlines(keepends=True)[-1])
    assert named(torquer("check", run), "bus.log")


# --- signed


@pytest.fixture
def keys(tmp_path):
    """Files of a private key, its public half, and the public half of another."""
    serialization = pytest.importorskip("cryptography.hazmat.primitives.serialization")
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    pem, public = serialization.Encoding.PEM, serialization.PublicFormat.SubjectPublicKeyInfo
    own, other = Ed25519PrivateKey.generate(), Ed25519PrivateKey.generate()
    contents = {
        "key.pem": own.private_bytes(pem, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()),
        "public.pem": own.public_key().public_bytes(pem, public),
        "other.pem": other.public_key().public_bytes(pem, public),
    }
    for name, content in contents.items():
        (tmp_path / name).write_bytes(content)
    return [tmp_path / name for name in contents]


@pytest.mark.long
@pytest.mark.slow
def test_a_signed_run_is_verified_by_every_command(torquer, keys, tmp_path):
    key, public, other = keys
    run = tmp_path / "signed"
    assert torquer("sil", *TINY, "--out", run, "--sign", key).code == 0
    signed = (run / "run.json").read_bytes()
    for done in says(torquer, run, "--verify", public).values():
        assert (done.code, done.err) == (0, "")
    assert (run / "run.json").read_bytes() == signed
    for done in says(torquer, run, "--verify", other).values():
        assert done.code == 1
        assert "run.json.sig is not the signature of run.json by this key" in done.out + done.err
    run_json = json.loads(signed)
    for forged in ({**run_json, "seed": 8}, {**run_json, "digests": {}}, {**run_json, "more": 1}):
        (run / "run.json").write_text(json.dumps(forged, indent=2) + "\n")
        for words in COMMANDS:
            done = torquer(words[0], run, *words[1:], "--verify", public)
            assert done.code == 1
            assert "run.json.sig is not the signature of run.json by this key" in done.out + done.err
    (run / "run.json").write_bytes(signed)
    (run / "summary.json").write_text("{}")
    assert named(torquer("check", run, "--verify", public), "summary.json")


def test_a_run_without_signature_is_not_verified(run, torquer, keys):
    for done in says(torquer, run, "--verify", keys[1]).values():
        assert done.code == 1
        assert "run.json is not signed: there is no run.json.sig beside it" in done.out + done.err
    (run / "run.json").unlink()
    for command in ("check", "replay"):
        done = torquer(command, run, "--verify", keys[1])
        assert done.code == 1
        assert "has no run.json, so that nothing is signed" in done.out


def test_a_signature_that_does_not_cover_a_file_is_not_enough(run, torquer, keys):
    from sim.record.signature import private_key, sign

    run_json = json.loads((run / "run.json").read_text())
    del run_json["digests"]["truth.h5"]
    (run / "run.json").write_text(json.dumps(run_json))
    sign(run / "run.json", private_key(keys[0]))
    done = torquer("check", run, "--verify", keys[1])
    assert done.code == 1
    assert "MISMATCH truth.h5 is not signed: run.json has no digest of it" in done.out


@pytest.mark.long
@pytest.mark.slow
def test_report_says_that_a_signature_no_longer_holds_and_signs_anew(run, torquer, keys):
    key, public, _ = keys
    assert torquer("report", run, "--sign", key).code == 0
    assert torquer("check", run, "--verify", public).code == 0
    run_json = json.loads((run / "run.json").read_text())
    run_json["flown"]["wall_s"] = 1.25  # the summary comes out otherwise
    (run / "run.json").write_text(json.dumps(run_json))
    done = torquer("report", run)
    assert done.code == 0
    assert "run.json is no longer what was signed: --sign KEY signs it again" in done.sentence
    assert torquer("check", run, "--verify", public).code == 1
    assert torquer("report", run, "--sign", key).err == ""
    assert torquer("check", run, "--verify", public).code == 0


def test_without_the_package_nothing_is_flown(torquer, run, keys, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "cryptography", None)
    done = torquer("sil", *TINY, "--out", tmp_path / "new", "--sign", keys[0])
    assert (done.code, done.out) == (2, "")
    assert "pip install 'torquer[sign]'" in done.sentence
    assert not (tmp_path / "new").exists()
    for command in ("check", "replay", "report"):
        done = torquer(command, run, "--verify", keys[1])
        assert done.code == 2
        assert "torquer[sign]" in done.sentence


@pytest.mark.parametrize("content", [None, b"", b"no key"])
def test_a_key_that_is_none_is_told_before_the_flight(torquer, tmp_path, content):
    pytest.importorskip("cryptography")
    key = tmp_path / "key.pem"
    if content is not None:
        key.write_bytes(content)
    done = torquer("sil", *TINY, "--out", tmp_path / "new", "--sign", key)
    assert (done.code, done.out) == (2, "")
    assert f"--sign {key}: " in done.sentence
    assert not (tmp_path / "new").exists()
