"""What ``torquer watch`` opens: a log where there is one of that name, else a bus."""

import pytest
from click.testing import CliRunner

from fsw.bus.interface import BusError
from fsw.input.schema import TableError
from fsw.wire.messages import CoilRefused, CoilRefusedReason
from sim.errors import HarnessError
from sim.record.pace import LOCKSTEP
from sim.watch import command, web
from sim.watch.source import BusSource, LogSource
from torquer.cli.main import main


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "some.log"
    path.write_text("(1.000000) x 180#0500000001000000\n(2.000000) x 510#0001000000000000\n")
    return path


def run(*arguments):
    result = CliRunner().invoke(main, ["watch", *map(str, arguments)])
    return result.exit_code, result.stdout, result.stderr


def test_a_log_a_bus_and_a_path_that_is_missing(log, tmp_path):
    assert isinstance(command.watch(str(log), LOCKSTEP, None).source, LogSource)
    assert isinstance(command.watch("loop:28990", LOCKSTEP, None).source, BusSource)
    with pytest.raises(HarnessError, match="no such file"):
        command.watch(str(tmp_path / "none.log"), LOCKSTEP, None)
    with pytest.raises(BusError, match=r"unknown bus 'lop'.*; nor is there a run or a log of that name"):
        command.watch("lop", LOCKSTEP, None)
    with pytest.raises(BusError) as caught:
        command.watch("socketcan:", LOCKSTEP, None)
    assert "a run" not in str(caught.value), "it can be nothing but a bus"


@pytest.mark.long
def test_the_orbit_is_that_of_the_run_or_of_a_scenario(log, recorded_run):
    assert command.watch(str(log), LOCKSTEP, None).view.around_at(0) is None
    for watched in (
        command.watch(str(log), LOCKSTEP, "microsat"),
        command.watch(str(recorded_run), LOCKSTEP, None),
    ):
        assert watched.view.around_at(0) is not None
    with pytest.raises(TableError, match="nosat"):
        command.watch(str(log), LOCKSTEP, "nosat")


def test_a_page_of_a_log_that_was_cut_short_fails_too(log, monkeypatch):
    log.write_text(log.read_text()[:-3])
    watched = command.watch(str(log), LOCKSTEP, None)
    monkeypatch.setattr(web, "serve", lambda view, port, say: view.read())
    with pytest.raises(HarnessError, match="the log was cut short"):
        command.serve_page(watched, 8025)


def test_a_log_that_was_cut_short_is_shown_and_fails(log):
    log.write_text(log.read_text()[:-3])
    code, _, errors = run(log, "--pace", "lockstep")
    assert (code, errors) == (1, f"torquer: {log}: the log was cut short: its last line is incomplete\n")


def test_a_log_that_is_read_at_once_tells_all_that_happens(log):
    refusal = CoilRefused(2, 7, CoilRefusedReason.LOCKOUT, 33).encode()
    log.write_text(f"(1.000000) x {refusal.can_id:03X}#{refusal.data.hex().upper()}\n" * 4000)
    code, out, _ = run(log, "--pace", "lockstep")
    assert (code, len(out.splitlines())) == (0, 4000)


@pytest.mark.parametrize(
    ("options", "shows"),
    [([], "show_on_terminal"), (["--web"], "serve_page"), (["--foxglove"], "serve_foxglove")],
)
def test_ctrl_c_is_how_it_ends(log, options, shows, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"sim.watch.command.{shows}", interrupt)
    assert run(log, *options) == (130, "", "")


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--web", "--foxglove"], "exclude each other"),
        (["--port", "8025"], "--port belongs to"),
        (["--pace", "slow"], "--pace slow"),
        (["--scenario", "nosat"], "nosat"),
    ],
)
def test_wrong_options_are_one_sentence(log, options, complaint):
    code, out, errors = run(log, *options)
    assert (code, out) == (2, "")
    assert complaint in errors
    assert len(errors.splitlines()) == 1
