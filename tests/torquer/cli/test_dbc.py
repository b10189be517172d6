"""``torquer dbc``: the file, and what it is not written over."""

import cantools
import pytest
from click.testing import CliRunner

from torquer.cli.main import main


def call(*words):
    return CliRunner().invoke(main, ["dbc", *map(str, words)])


@pytest.mark.parametrize(("options", "cycle_ms"), [((), 1000), (("--tick-hz", "4"), 250)])
def test_it_writes_a_dbc_with_cycle_times(tmp_path, options, cycle_ms):
    out = tmp_path / "deep" / "bus.dbc"
    done = call("--out", out, *options)
    assert (done.exit_code, done.stdout) == (0, f"written: {out}\n")
    assert cantools.database.load_file(out).get_message_by_name("SYNC").cycle_time == cycle_ms


def test_a_file_that_is_there_is_replaced_by_force_alone(tmp_path):
    out = tmp_path / "bus.dbc"
    out.write_text("mine")
    refused = call("--out", out)
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert "already exists" in refused.stderr
    assert out.read_text() == "mine"
    assert call("--out", out, "--force").exit_code == 0
    assert "GenMsgCycleTime" in out.read_text()


def test_without_a_file_it_is_on_stdout_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = call("--tick-hz", "4")
    assert (done.exit_code, done.stderr) == (0, "")
    assert cantools.database.load_string(done.stdout).get_message_by_name("SYNC").cycle_time == 250
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "words", [("--force",), ("--out", "/dev/null"), ("--out", "bus.dbc", "--tick-hz", "0")]
)
def test_what_cannot_be_written_is_one_sentence(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    refused = call(*words)
    assert (refused.exit_code, refused.stderr.count("\n")) == (2, 1)
    assert list(tmp_path.iterdir()) == []
