"""What a replay of a run reports: only a log that has ticks, and those of its run, is exact."""

import json
import shutil

import pytest

from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import PlantEnd, Sync, TickDone
from sim.errors import HarnessError
from sim.record import run_dir
from sim.record.binding import Binding
from sim.record.candump import read_log
from sim.replay.command import LoggedRun, as_json, through_flight_software, through_plant


@pytest.fixture
def run(recorded_run, tmp_path):
    """Log and run of a recorded flight, with other values in its run.json."""

    def make(log=None, **values):
        folder = shutil.copytree(recorded_run, tmp_path / "run")
        record = json.loads((folder / run_dir.RUN).read_text()) | values
        path = folder / run_dir.BUS_LOG
        if log is not None:
            path.write_text(log)
        return path, LoggedRun(run_dir.read_scenario(folder), record, Binding({}))

    return make


@pytest.fixture
def log_of_no_tick(recorded_run):
    """The boot of the flight software, then the end."""
    boot = next(iter(read_log(recorded_run / run_dir.BUS_LOG)))
    stamp = format_time(boot.timestamp_us)
    return "".join(format_line(stamp, "vcan0", frame) for frame in (boot.frame, PlantEnd(0).encode()))


@pytest.mark.parametrize("through", [through_flight_software, through_plant])
def test_a_log_without_a_tick_is_not_exact(run, log_of_no_tick, through):
    report = through(*run(log_of_no_tick))
    assert not report.ok
    assert "nothing was replayed: the log has no tick" in report.lines
    assert not any("exact:" in line or "reproduced" in line for line in report.lines)
    assert as_json(report)["ok"] is False


@pytest.mark.parametrize("through", [through_flight_software, through_plant])
@pytest.mark.parametrize(
    ("complete", "flown", "ok"), [(True, 300, True), (True, 301, False), (False, 301, True)]
)
def test_a_log_has_as_many_ticks_as_its_complete_run(run, through, complete, flown, ok):
    report = through(*run(complete=complete, flown={"ticks": flown}))
    assert report.ok is ok
    told = "differs: the log ends after 300 ticks, and run.json names 301" in report.lines
    assert told is not ok


def test_telecommands_of_the_scenario_go_up_and_not_to_the_boards(fly_run):
    """A fault that draws a random number for each frame to the boards draws as many in the replay."""
    folder = fly_run(
        120,
        telecommand=[{"message": "TC_FREEZE", "at_s": at_s, "frozen": True} for at_s in (50.0, 50.0, 70.0)],
        fault=[{"kind": "loss", "at_s": 10.0, "parameters": {"part": 0.2}}],
    )
    record = json.loads((folder / run_dir.RUN).read_text())
    logged = LoggedRun(run_dir.read_scenario(folder), record, Binding({}))
    report = through_plant(folder / run_dir.BUS_LOG, logged)
    assert report.ok, report.lines


@pytest.mark.parametrize("frames", [60.0, 1000.0])
def test_a_flood_of_frames_from_the_first_tick_on_replays_to_the_bit(fly_run, frames):
    """More than the gate reads in a tick: which of them it reads depends on all that came before."""
    flood = {"kind": "second_sender", "at_s": 0.0, "parameters": {"frames": frames}}
    folder = fly_run(12, fault=[flood])
    record = json.loads((folder / run_dir.RUN).read_text())
    logged = LoggedRun(run_dir.read_scenario(folder), record, Binding({}))
    report = through_flight_software(folder / run_dir.BUS_LOG, logged)
    assert report.ok, report.lines


def test_a_log_without_a_frame_of_the_flight_software_is_not_replayed(run):
    sync = format_line(format_time(0), "vcan0", Sync(0, 0).encode())
    with pytest.raises(HarnessError, match="no frame of the flight software in it: nothing to compare"):
        through_flight_software(*run(sync))


def test_of_one_that_gives_no_state_crc_it_is_said(run, recorded_run):
    """A state CRC of 0 says that there is none: the replay differs, and says why no CRC can agree."""
    log, flown = run("".join(_without_state_crc(recorded_run / run_dir.BUS_LOG)))
    report = through_flight_software(log, flown)
    assert not report.ok
    assert "its TICK_DONE gives no CRC of the state (0): another flight software has flown" in report.lines
    assert not any(
        "no CRC" in line for line in through_flight_software(recorded_run / run_dir.BUS_LOG, flown).lines
    )


def _without_state_crc(log):
    for entry in read_log(log):
        frame = entry.frame
        if frame.can_id == TickDone.ID:
            frame = TickDone(TickDone.decode(frame.data).tick, 0).encode()
        yield format_line(format_time(entry.timestamp_us), entry.channel, frame)


def test_a_run_of_another_flight_software_is_not_replayed_through_this_one(run):
    log, flown = run(flight_software={"command": "./firmware", "profile": "actuator"})
    with pytest.raises(
        HarnessError, match=r"another flight software has flown, .* --plant replays the plant"
    ):
        through_flight_software(log, flown)
    assert through_plant(log, flown).ok
