"""A flight with the continuous driver and every disturbance: audited, and replayed through both."""

import json

import h5py
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.wire.messages import CoilDipole, CoilDipoleStatus, CoilFire, CoilRefused, CoilStatus, Sync

TURNS_DEG = [[0.3, -0.2, 0.4], [0.1, 0.5, -0.3], [-0.2, 0.3, 0.1]]
SETTINGS = (
    "coils.driver=continuous",
    "coils.max_dipole_am2=12",
    "body.plates=[{area_m2=0.3, normal=[0, 1, 0], centre_m=[0.01, 0.02, 0.03]}]",
    "disturbance.drag={}",
    "disturbance.solar_pressure={}",
    "disturbance.eddy_nms_per_t2=100",
    "disturbance.torque_noise_nm_rts=1e-8",
    "sensors.sun.fov_half_deg=100",
    "sensors.sun.boresights=[[1, 0, 0], [0, 1, 0]]",
    "sensors.magnetometer.latency_s=0.05",
    "sensors.magnetometer.non_orthogonality_deg=[0.2, -0.3, 0.1]",
    "sensors.sun.albedo=true",
    f"coils.misalignment_deg={TURNS_DEG}",
    "disturbance.torque_daily_part=0.5",
    "disturbance.residual_dipole_eclipse_am2=[0.001, -0.002, 0.001]",
    "disturbance.remanence_part=0.005",
    "orbit.along_track_km=5",
)


@pytest.fixture
def flight(sil_run):
    settings = [word for setting in SETTINGS for word in ("--set", setting)]
    return sil_run("microsat", "--orbits", "0.08", "--bus", "virtual", *settings)


@pytest.mark.long
def test_what_is_asked_in_a_tick_is_told_at_the_next_and_has_flowed(flight, copy_of):
    log = copy_of(flight)
    requested, reported, ticks, last = [], [], 0, None
    for _, _, frame in log.entries:
        if frame.can_id == CoilDipoleStatus.ID:
            reported.append(CoilDipoleStatus.decode(frame.data).values()[:3])
        elif frame.can_id == Sync.ID:
            requested.append(last)
            last, ticks = None, ticks + 1
        elif frame.can_id == CoilDipole.ID:
            assert last is None
            last = CoilDipole.decode(frame.data).values()[:3]
    assert len(reported) == ticks == len(log.where(CoilStatus))
    requested = [m or (0.0, 0.0, 0.0) for m in requested]
    assert reported == requested
    assert sum(map(any, reported)) > 100
    assert log.where(CoilFire) == log.where(CoilRefused) == []
    with h5py.File(flight / "truth.h5") as truth:
        flowed = truth["m_body_am2"][:]
        assert {"drag", "solar_pressure", "eddy", "noise", "coils"} <= set(truth["torque_body_nm"])
    turned = Rotation.from_rotvec(TURNS_DEG, degrees=True)
    axes = np.array([turned[coil].apply(axis) for coil, axis in enumerate(np.eye(3))])
    assert flowed == pytest.approx(9.6 * np.array(reported) @ axes, rel=1e-7, abs=1e-7)


@pytest.mark.long
def test_the_audit_judges_what_the_dipole_status_reports(flight, torquer, copy_of):
    done = torquer("check", flight)
    assert (done.code, done.err) == (0, "")
    lines = done.out.splitlines()
    assert lines[-1] == "OK: continuous driver within full scale"
    dipoles = [frame for _, _, frame in copy_of(flight).entries if frame.can_id == CoilDipoleStatus.ID]
    driven = sum(any(CoilDipoleStatus.decode(frame.data).values()[:3]) for frame in dipoles)
    assert f"driven in {driven} of 483 ticks, duty {100 * 0.8 * driven / 483:.2f} %" in lines[1]
    assert "one coil at a time" not in done.out


def test_the_same_log_without_its_scenario_breaks_the_limits_of_a_pulsed_driver(flight, torquer, tmp_path):
    bare = tmp_path / "bare.log"
    bare.write_bytes((flight / "bus.log").read_bytes())
    done = torquer("check", bare)
    assert done.code == 1
    assert "a pulsed driver reports" in done.out


@pytest.mark.long
def test_the_summary_has_what_was_driven_and_for_how_long(flight, torquer):
    summary = json.loads((flight / "summary.json").read_text())
    dipoles = summary["dipoles"]
    assert (dipoles["total"], dipoles["driven"] > 100) == (483, True)
    assert summary["duty"]["total"] == pytest.approx(0.8 * dipoles["driven"] / 483)
    assert summary["duty"]["per_coil"] == pytest.approx([0.8 * one / 483 for one in dipoles["per_coil"]])
    driven = f"limits     kept: driven in {dipoles['driven']} of 483 ticks, 0 refused"
    assert driven in torquer("report", flight).out


def test_a_level_on_such_a_board_is_a_pulse_to_the_audit(flight, torquer, copy_of):
    copy = copy_of(flight)
    copy.change(copy.where(CoilStatus)[30], level=2)
    done = torquer("check", copy.write())
    assert done.code == 1
    assert "the boot of the board" in done.out
    assert "a continuous driver reports level 2" in done.out


def test_it_replays_through_controller_and_plant(flight, torquer):
    assert "bit-exact" in torquer("replay", flight).out
    done = torquer("replay", "--plant", flight)
    assert (done.code, done.err) == (0, "")
    assert "every frame equal" in done.out
