"""What a user mistypes is answered with what may have been meant: one sentence on stderr, exit code 2."""

import errno
import os
import subprocess
import sys

import click
import pytest

from torquer.cli.main import main


def run(capsys, *words):
    """(exit code, stdout, stderr) of a command line."""
    with pytest.raises(SystemExit) as ended:
        main.main(list(words), prog_name="torquer")
    return ended.value.code, *capsys.readouterr()


@pytest.mark.long
@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (["sli"], "'sil'"),
        (["Replay", "x"], "'replay'"),
        (["sil", "--orbit", "3"], "'--orbits'"),
        (["sil", "--json", "--sett", "a=1"], "'--set'"),
        (["sil", "microsta"], "'microsat'"),
        (["design", "cubesat-3u"], "'cubesat3u'"),
        (["sil", "--set", "control.lwa=pd"], "'law'"),
        (["sil", "--set", "controll.law=pd"], "'control'"),
        (["sil", "--set", "control.law=mcp"], "'mpc'"),
        (["sil", "--set", "coils.backoff=percoil"], "'per_coil'"),
        (["sil", "--set", "sensors.magnetometer.noise=1"], "'noise_nt'"),
        (["sil", "--set", "flight.control.lwa=pd"], "'law'"),
        (["compare", "microsat", "--laws", "slidng"], "'sliding'"),
        (["compare", "--driver", "pulse"], "'pulsed'"),
        (["faults", "--row", "mag-bais"], "'mag-bias"),
        (["validate", "--only", "posta1"], "'posat1"),
        (["hil", "--real", "coils"], "'coil'"),
        (["board", "magnetmeter", "--bus", "loop"], "'magnetometer'"),
        (["completion", "bahs"], "'bash'"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_may_have_been_meant(words, meant, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *words)
    assert (code, out) == (2, "")
    assert f"did you mean {meant}" in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sil", "--law", "my_law.py"], "--law my_law.py: which law of the file? Write my_law.py:NAME"),
        (["compare", "--law", "my_law:damp"], "--law my_law:damp: did you mean my_law.py:damp?"),
        (["completion"], "Missing argument '{bash|zsh|fish}'. Choose from: bash, zsh, fish"),
        (["sil", "--orbits", "two"], "'two' is not a valid number"),
        (["campaign", "microsat", "--runs", "2.5"], "'2.5' is not a valid whole number"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_what_to_write_instead_is_told(words, says, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my_law.py").write_text("")
    code, out, err = run(capsys, *words)
    assert (code, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


@pytest.mark.parametrize("words", [["sil", "zzz"], ["zzz"], ["sil", "--zzz"], ["sil", "--set", "zzz=1"]])
def test_nothing_is_guessed_where_nothing_is_near(words, capsys):
    code, _, err = run(capsys, *words)
    assert code == 2
    assert "did you mean" not in err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--laws", "pd", "--out", "here"], "--out has no effect with --laws: the gains go to --keep"),
        (["--laws", "pd", "--write"], "--write has no effect with --laws"),
        (["--laws", "pd", "--gains", "1e6", "100"], "--gains has no effect with --laws"),
        (["--keep", "a.toml"], "--keep belongs to --laws"),
        (["--flights", "8"], "--flights belongs to --laws"),
    ],
    ids=lambda value: value[-2] if isinstance(value, list) else "",
)
def test_options_of_the_two_searches_for_gains_are_not_mixed(words, says, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, "design", "microsat", *words)
    assert (code, out) == (2, "")
    assert says in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["hil", "--seconds", "nan"], "--seconds nan"),
        (["hil", "--warm-s", "nan"], "--warm-s nan"),
        (["hil", "--jitter-ms", "inf"], "--jitter-ms inf"),
        (["phasing", "microsat", "--field-nt", "1", "nan", "3"], "--field-nt nan"),
        (["phasing", "microsat", "--coil-field-nt-per-am2=-inf"], "--coil-field-nt-per-am2 -inf"),
        (["telemetry", "pass.csv", "--tle", "tle.txt", "--start", "nan"], "--start nan"),
        (["design", "microsat", "--gains", "nan", "1"], "--gains nan"),
        (["size", "--altitude-km", "nan"], "--altitude-km nan"),
    ],
)
def test_a_number_that_is_not_finite_is_refused(words, says, capsys):
    assert run(capsys, *words) == (2, "", f"torquer: {says}: is not a finite number\n")


@pytest.mark.parametrize(
    "option", ["--jitter-ms", "--latency-ms", "--slips", "--load-percent", "--memory-percent"]
)
def test_a_budget_that_no_bench_could_keep_is_refused(option, capsys):
    code, out, err = run(capsys, "hil", f"{option}=-1")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert f"{option}" in err
    assert "-1" in err


def test_a_folder_that_is_gone_is_one_sentence(tmp_path, monkeypatch, capsys):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert run(capsys, "doctor") == (
        2,
        "",
        "torquer: the folder that this runs in is no longer there: cd to another\n",
    )


@pytest.mark.long
def test_so_is_it_where_the_command_is_run_as_a_module(tmp_path):
    gone = tmp_path / "gone"
    gone.mkdir()
    remove_it = f"import os, runpy, sys; os.rmdir({str(gone)!r}); sys.argv[1:] = ['doctor']; "
    run_it = "runpy.run_module('torquer', run_name='__main__', alter_sys=True)"
    words = [sys.executable, "-c", remove_it + run_it]
    done = subprocess.run(words, cwd=gone, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "torquer: the folder that this runs in is no longer there: cd to another\n"


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (
            OSError(errno.ENOENT, "No such file"),
            (2, "the system refuses (No such file), and does not say of"),
        ),
        (OSError(errno.EMFILE, "Too many files"), (2, "the system refuses (Too many files), and does not")),
        (OSError(errno.EFBIG, "File too large"), (1, "there is no room to write (File too large); what")),
        (OSError(errno.ENOSPC, "No space"), (1, "there is no room to write (No space); what was")),
        (OSError(errno.ENOSPC, "No space", "x.csv"), (1, "x.csv: there is no room to write (No space); ")),
        (OSError(errno.ENOMEM, "Cannot allocate"), (1, "there is not enough memory; what was")),
        (MemoryError(), (1, "there is not enough memory; what was")),
        (ImportError("x.so: failed to map segment from shared object"), (1, "there is not enough memory; ")),
    ],
    ids=lambda value: repr(value) if isinstance(value, Exception) else "",
)
def test_what_the_system_refuses_is_one_sentence_that_guesses_no_file(error, says, monkeypatch, capsys):
    def refuse(*words, **options):
        raise error

    monkeypatch.setattr(click.Group, "main", refuse)
    code, out, err = run(capsys, "scenarios")
    assert (code, out, err.count("\n")) == (says[0], "", 1)
    assert err.startswith(f"torquer: {says[1]}")


@pytest.mark.skipif(sys.platform == "win32", reason="there is no such limit")
@pytest.mark.parametrize("limit_mb", [100, 250, 399])
def test_too_little_memory_is_one_sentence_and_no_hang(limit_mb, tmp_path):
    import resource

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (limit_mb * 1_000_000,) * 2)

    words = [sys.executable, "-m", "torquer", "campaign", "microsat", "--out", tmp_path / "campaign"]
    done = subprocess.run(words, capture_output=True, text=True, check=False, preexec_fn=limit, timeout=60)
    told = f"this process may have {limit_mb} MB (ulimit -v), and torquer needs 400 MB"
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == f"torquer: there is not enough memory: {told}\n"
    assert not (tmp_path / "campaign").exists()


@pytest.mark.parametrize("error", [ImportError("no name x in y"), OSError("of nothing")])
def test_what_may_be_a_defect_is_no_sentence(error, monkeypatch):
    def refuse(*words, **options):
        raise error

    monkeypatch.setattr(click.Group, "main", refuse)
    with pytest.raises(type(error)):
        main(["scenarios"], prog_name="torquer")


def test_elements_from_a_pipe_are_refused_at_once(tmp_path, capsys):
    os.mkfifo(tmp_path / "tle.txt")
    code, out, err = run(capsys, "size", "--tle", str(tmp_path / "tle.txt"))
    assert (code, out) == (2, "")
    assert f"{tmp_path / 'tle.txt'}: cannot be read" in err


REFUSED = """
import sys
from torquer.cli.main import main
try:
    main.main(sys.argv[1:], prog_name="torquer")
except SystemExit as ended:
    slow = {"matplotlib.figure", "scipy.stats", "scipy.optimize"} & set(sys.modules)
    print(ended.code, *sorted(slow))
"""


@pytest.mark.long
@pytest.mark.parametrize("command", ["sil", "size", "design", "compare", "campaign", "hil"])
def test_a_malformed_scenario_is_refused_before_what_takes_long_to_load(tmp_path, command):
    path = tmp_path / "bad.toml"
    path.write_text('name = "bad"\n')
    words = [sys.executable, "-c", REFUSED, command, str(path)]
    done = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
    assert "bad.toml: summary is missing" in done.stderr
    assert done.stdout.split() == ["2"]
