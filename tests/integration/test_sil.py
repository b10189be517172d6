"""``torquer sil``: plant and flight software as two processes on the loop bus."""

import json
import tomllib

import h5py
import numpy as np
import pytest

from fsw.bus.open_bus import resolve
from fsw.wire.messages import (
    CoilFire,
    CoilStatus,
    FswBoot,
    MagField,
    PlantEnd,
    PlantHeartbeat,
    RefAttitude,
    SunVector,
    Sync,
    TickDone,
)

pytestmark = pytest.mark.long

FILES = {"run.json", "scenario.toml", "bus.log", "bus.log.index", "truth.h5", "summary.json", "report.html"}
RUN_KEYS = {
    "schema_version", "torquer_version", "scenario", "scenario_sha256", "flight_table_crc", "seed", "bus",
    "pace", "platform", "complete",
}  # fmt: skip
SUMMARY_KEYS = {
    "scenario", "seed", "sim_seconds", "wall_seconds", "realtime_factor", "ticks", "slips", "pulses", "duty",
    "min_gap_s", "max_pulse_s", "limits_ok", "pointing_deg", "axis1_deg", "mode_final",
    "isolated", "events",
}  # fmt: skip
TRUTH = {
    "t_s": 0, "q_body_from_orbit": 4, "omega_body_orbit_radps": 3, "b_body_t": 3, "sun_body": 3, "lit": 0,
    "m_body_am2": 3, "r_eci_m": 3,
}  # fmt: skip

SHORT = ("microsat", "--seed", "7", "--orbits", "0.05")
TICKS = 302  # of 6041.25 s
EPOCH = "time.epoch_utc=2024-02-29T23:59:00Z"
CIRCLE = ("orbit.altitude_km=600", "orbit.inclination_deg=51.6")


def read(run, name):
    return json.loads((run / name).read_text())


def of(frames, message):
    return [message.decode(frame.data) for frame in frames if frame.can_id == message.ID]


# --- the run directory


@pytest.fixture(scope="module")
def run(sil_run):
    return sil_run(*SHORT, "--bus", "loop")


def test_a_run_leaves_its_files_and_no_others(run):
    assert {path.name for path in run.iterdir()} == FILES


def test_run_json(run):
    content = read(run, "run.json")
    assert set(content) >= RUN_KEYS
    assert content["complete"] is True
    assert (content["scenario"], content["seed"], content["ticks"]) == ("microsat", 7, TICKS)
    assert (content["bus"], content["pace"]) == ("loop", "lockstep")
    assert set(content["platform"]) >= {"cpu", "python", "numpy", "blas"}


def test_summary(run):
    summary = read(run, "summary.json")
    assert set(summary) >= SUMMARY_KEYS
    assert set(summary["pulses"]) >= {"total", "per_coil", "refused"}
    assert set(summary["duty"]) == {"per_coil", "total"}
    assert set(summary["min_gap_s"]) == {"per_coil", "any", "limited"}
    assert set(summary["pointing_deg"]) == {"final", "rms_last_orbit", "max_last_orbit"}
    assert set(summary["axis1_deg"]) >= {"final", "rms_last_orbit", "max_last_orbit", "mean_last_orbit"}
    assert summary["ticks"] == summary["sim_seconds"] == TICKS
    assert summary["limits_ok"] is True
    assert summary["slips"] == summary["pulses"]["refused"] == 0
    assert summary["realtime_factor"] == pytest.approx(TICKS / summary["wall_seconds"])
    assert summary["replay"]["bit_exact"] is True


def test_a_longer_run_judges_the_estimate(sil_run):
    run = sil_run("microsat", "--orbits", "0.12", "--bus", "virtual")
    summary = read(run, "summary.json")
    assert set(summary["estimate_deg"]) >= {"max", "within_3sigma"}
    assert summary["converged_at_s"] < 100
    assert summary["nees_mean"] > 0


def test_pulses_in_the_summary_are_those_on_the_bus(run, bus):
    pulses = read(run, "summary.json")["pulses"]
    fired = of(bus(run).frames, CoilFire)
    driven = [status for status in of(bus(run).frames, CoilStatus) if status.level]
    assert pulses["total"] == len(fired) == sum(pulses["per_coil"]) > 0
    assert len({status.seq for status in driven}) == len(fired)


def test_truth_has_a_row_a_tick_with_units(run):
    with h5py.File(run / "truth.h5") as truth:
        for name, width in TRUTH.items():
            assert truth[name].shape == ((TICKS, width) if width else (TICKS,))
            assert np.isfinite(truth[name]).all()
            assert truth[name].attrs["unit"]
        assert len(truth["torque_body_nm"]) > 2
        for torque in truth["torque_body_nm"].values():
            assert torque.shape == (TICKS, 3)
            assert torque.attrs["unit"] == "N m"
        assert list(truth["t_s"]) == list(range(TICKS))
        assert np.linalg.norm(truth["q_body_from_orbit"], axis=1) == pytest.approx(np.ones(TICKS), abs=1e-12)


def test_every_tick_is_on_the_bus_in_its_order(run, bus):
    times, frames = bus(run)
    assert frames[0].can_id == FswBoot.ID
    assert (frames[-1].can_id, of(frames, PlantEnd)[0].ticks) == (PlantEnd.ID, TICKS)
    for message in (MagField, SunVector, CoilStatus, Sync, TickDone):
        assert len(of(frames, message)) == TICKS, message
    assert [sync.tick for sync in of(frames, Sync)] == [done.tick for done in of(frames, TickDone)]
    ticks = [us // 1_000_000 - times[0] // 1_000_000 for us in times]
    order = [(tick, frame.can_id) for tick, frame in zip(ticks, frames, strict=True)]
    for tick in range(TICKS):
        board, sync, done = ((tick, m.ID) for m in (MagField, Sync, TickDone))
        assert order.index(board) < order.index(sync) < order.index(done)
    assert ticks == sorted(ticks)


def test_the_scenario_beside_a_run_flies_it_again(run, sil_run, bus):
    again = sil_run(str(run / "scenario.toml"), "--seed", "7", "--orbits", "0.05", "--bus", "virtual")
    assert bus(again) == bus(run)


def test_bus_summary_and_report_are_named(torquer, tmp_path):
    done = torquer("sil", "--orbits", "0.003", "--out", tmp_path / "run")
    assert done.code == 0
    assert done.sentence == f"bus: {resolve('auto').partition(':')[0]} (auto)"
    assert "realsat, seed 1: 18 s flown" in done.out
    assert done.out.endswith(f"report: {tmp_path / 'run' / 'report.html'}\n")
    report = (tmp_path / "run" / "report.html").read_text()
    assert report.lower().startswith("<!doctype html>")
    assert "realsat" in report


def test_without_out_a_run_is_named_by_scenario_and_time(torquer, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for _ in range(2):
        assert torquer("sil", "cubesat3u", "--orbits", "0.001", "--bus", "virtual").code == 0
    folders = list((tmp_path / "runs").iterdir())
    assert len(folders) == 2
    assert all(folder.name.startswith("cubesat3u-2") for folder in folders)
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


@pytest.mark.slow
def test_the_nodes_run_the_same_code_whatever_lies_around(torquer, tmp_path, monkeypatch):
    for package in ("fsw", "sim", "sim/plant", "can"):
        (tmp_path / package).mkdir()
        for module in ("__init__", "__main__"):
            (tmp_path / package / f"{module}.py").write_text("raise SystemExit('the wrong code')\n")
    monkeypatch.chdir(tmp_path)
    assert torquer("sil", "--orbits", "0.001", "--bus", "loop", "--out", "run").code == 0


# --- determinism


def test_the_same_seed_gives_the_same_bytes(run, sil_run):
    again = sil_run("--seed", "7", "--orbits", "0.05", "microsat", "--bus", "loop")
    assert again != run
    for name in ("bus.log", "bus.log.index", "scenario.toml"):
        assert (again / name).read_bytes() == (run / name).read_bytes()
    with h5py.File(run / "truth.h5") as one, h5py.File(again / "truth.h5") as other:
        assert all(np.array_equal(one[name], other[name]) for name in TRUTH)
    first, second = (read(path, "summary.json") for path in (run, again))
    for summary in (first, second):
        del summary["wall_seconds"], summary["realtime_factor"]
    assert first == second


def test_another_seed_gives_other_samples(run, sil_run, bus):
    other = sil_run("microsat", "--seed", "8", "--orbits", "0.05", "--bus", "virtual")
    first, second = (of(bus(path).frames, MagField) for path in (run, other))
    same = sum(mine.values()[1:4] == yours.values()[1:4] for mine, yours in zip(first, second, strict=True))
    assert same < 3


@pytest.mark.parametrize(
    ("scenario", "settings"),
    [
        ("microsat", ("time.orbits=0.05",)),
        ("cubesat3u", ("time.orbits=0.03", "time.tick_hz=2", "coils.backoff=per_coil")),
        ("microsat", ("time.orbits=0.018", "time.tick_hz=5", *CIRCLE)),
        ("microsat", ("time.orbits=0.018", "time.tick_hz=10", EPOCH)),
        ("posat1", ("time.orbits=0.04",)),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value[1:]) or "default",
)  # fmt: skip
@pytest.mark.slow
def test_loop_and_virtual_carry_the_same_frames_in_the_same_order(scenario, settings, sil_run, bus, torquer):
    options = [word for setting in settings for word in ("--set", setting)]
    two, one = (sil_run(scenario, *options, "--bus", kind) for kind in ("loop", "virtual"))
    assert bus(two) == bus(one)
    table = tomllib.loads((two / "scenario.toml").read_text())
    tick_hz, frames = table["time"]["tick_hz"], bus(two).frames
    ticks = read(two, "run.json")["ticks"]
    assert len(of(frames, TickDone)) == ticks == read(two, "summary.json")["ticks"]
    assert len(of(frames, CoilFire)) > 0, "nothing was fired: too short to tell"
    syncs = of(frames, Sync)
    assert [sync.unix_time_s - syncs[0].unix_time_s for sync in syncs] == [k // tick_hz for k in range(ticks)]
    assert torquer("check", two).code == 0
    assert torquer("replay", two).code == 0
    assert torquer("replay", two, "--plant").code == 0


# --- what scenario keys do


def test_ticks_bear_the_epoch_and_the_rate(sil_run, bus):
    settings = ("time.orbits=0.018", "time.tick_hz=10", EPOCH)
    run = sil_run("microsat", *(w for s in settings for w in ("--set", s)), "--bus", "loop")
    times, frames = bus(run)
    epoch_s = 1709251140
    assert times[0] == epoch_s * 1_000_000
    assert sorted(set(times)) == [epoch_s * 1_000_000 + tick * 100_000 for tick in range(1088)]
    assert of(frames, Sync)[605] == Sync(tick=605, unix_time_s=epoch_s + 60)


def test_the_epoch_of_a_tle_is_its_own_rounded_up(run, bus):
    assert bus(run).times_us[0] == 1427424417_000000  # day 86.11593543 of 2015: 02:46:56.82


def test_setting_a_key_of_a_circle_replaces_the_tle(sil_run):
    settings = ("time.orbits=0.018", "time.tick_hz=5", *CIRCLE)
    run = sil_run("microsat", *(w for s in settings for w in ("--set", s)), "--bus", "loop")
    orbit = tomllib.loads((run / "scenario.toml").read_text())["orbit"]
    assert "tle" not in orbit
    assert (orbit["altitude_km"], orbit["inclination_deg"], orbit["raan_deg"]) == (600.0, 51.6, 0.0)
    with h5py.File(run / "truth.h5") as truth:
        assert np.linalg.norm(truth["r_eci_m"], axis=1) == pytest.approx(6978137.0)
        assert truth["r_eci_m"][0] == pytest.approx([6978137.0, 0.0, 0.0])


def test_per_coil_lets_another_coil_fire_sooner(sil_run, torquer):
    settings = ("time.orbits=0.03", "time.tick_hz=2", "coils.backoff=per_coil")
    run = sil_run("cubesat3u", *(w for s in settings for w in ("--set", s)), "--bus", "loop")
    gaps = read(run, "summary.json")["min_gap_s"]
    assert gaps["any"] < 100.0
    assert all(gap is None or gap >= 100.0 for gap in gaps["per_coil"])
    assert torquer("check", run).code == 0
    assert torquer("check", run, "--backoff", "shared").code == 1


def test_perfect_knowledge_comes_over_the_bus(sil_run, run, bus):
    posat1 = sil_run("posat1", "--set", "time.orbits=0.04", "--bus", "loop")
    microsat = sil_run("microsat", "--orbits", "0.005", "--set", "knowledge=perfect", "--bus", "virtual")
    for perfect in (posat1, microsat):
        assert len(of(bus(perfect).frames, RefAttitude)) == read(perfect, "run.json")["ticks"]
    assert of(bus(run).frames, RefAttitude) == []


# --- real time


@pytest.mark.parametrize("factor", [400, 100_000])
def test_real_time_keeps_to_the_clock_and_counts_slips(factor, sil_run, bus, torquer):
    run = sil_run("microsat", "--orbits", "0.05", "--pace", f"realtime:{factor}", "--bus", "loop")
    summary = read(run, "summary.json")
    times, frames = bus(run)
    logged = list(zip(times, frames, strict=True))
    asked = {us: Sync.decode(frame.data).tick for us, frame in logged if frame.can_id == Sync.ID}
    done = [(us, TickDone.decode(frame.data).tick) for us, frame in logged if frame.can_id == TickDone.ID]
    late = sum(asked[us] != tick for us, tick in done)
    assert summary["slips"] in (late, late + 1), "of the last tick one cannot tell"
    assert read(run, "run.json")["pace"] == "realtime"
    assert summary["wall_seconds"] >= TICKS / factor * 0.99
    if factor == 400:
        assert summary["wall_seconds"] < TICKS / factor + 1.0
    else:
        assert late > 0
        assert [beat.slips for beat in of(frames, PlantHeartbeat)][-1] > 0
    assert len(of(frames, TickDone)) == TICKS, "a late answer is in the log too"
    assert torquer("replay", run).out.startswith("bit-exact")
    assert torquer("replay", run, "--plant").code == 0
    assert torquer("check", run).code == 0
