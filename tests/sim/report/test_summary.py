"""summary.json: every key of the contract, each number of a real flight by a second formula."""

import shutil

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fsw.compiled import standing
from fsw.wire.messages import CoilFire, Mode
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.truth import read_truth
from sim.report.conclude import conclude
from sim.report.summary import summary_text

CONTRACT = {
    "scenario": None,
    "seed": None,
    "sim_seconds": None,
    "wall_seconds": None,
    "realtime_factor": None,
    "ticks": None,
    "slips": None,
    "pulses": {"total", "per_coil", "refused"},
    "duty": {"per_coil", "total"},
    "min_gap_s": {"per_coil", "any"},
    "max_pulse_s": None,
    "limits_ok": None,
    "pointing_deg": {"final", "rms_last_orbit", "max_last_orbit"},
    "axis1_deg": {"final", "rms_last_orbit", "max_last_orbit", "mean_last_orbit"},
    "mode_final": None,
    "isolated": None,
    "event_count": None,
    "events": None,
}
"""What every flight has; ``estimate_deg``, ``converged_at_s``, ``nees_mean``, ``spin_radps`` come on top."""


@pytest.fixture(scope="module")
def summary(concluded, strict):
    return strict((concluded / run_dir.SUMMARY).read_text())


class TestRealFlight:
    def test_has_every_key_of_the_contract(self, summary):
        for key, inner in CONTRACT.items():
            assert key in summary
            assert inner is None or inner <= set(summary[key]), key

    def test_a_run_is_complete_once_it_has_been_concluded(self, recorded_run, concluded):
        assert run_dir.read_run(recorded_run)["complete"] is False
        assert run_dir.read_run(concluded)["complete"] is True
        assert {file.name for file in concluded.iterdir()} == {
            "run.json",
            "scenario.toml",
            "bus.log",
            "bus.log.index",
            "truth.h5",
            "summary.json",
            "report.html",
        }

    @pytest.mark.long
    def test_a_run_that_was_cut_is_concluded_but_not_complete(self, recorded_run, tmp_path):
        shutil.copytree(recorded_run, tmp_path / "run")
        log = tmp_path / "run" / run_dir.BUS_LOG
        log.write_bytes(log.read_bytes()[:40_000])
        made = conclude(tmp_path / "run")
        assert made["replay"]["bit_exact"] is True
        assert made["replay"]["ticks"] < 300
        assert run_dir.read_run(tmp_path / "run")["complete"] is False

    @pytest.mark.long
    def test_a_run_that_never_ended_its_flight_is_not_complete(self, recorded_run, tmp_path):
        shutil.copytree(recorded_run, tmp_path / "run")
        run = run_dir.read_run(tmp_path / "run")
        run.pop("flown")
        run_dir.write_json(tmp_path / "run" / run_dir.RUN, run)
        made = conclude(tmp_path / "run")
        assert "wall_seconds" not in made
        assert "slips" not in made
        assert run_dir.read_run(tmp_path / "run")["complete"] is False

    def test_time(self, summary):
        assert (summary["scenario"], summary["seed"], summary["ticks"], summary["slips"]) == (
            "microsat",
            5,
            300,
            0,
        )
        assert summary["sim_seconds"] == 300.0
        assert summary["realtime_factor"] == pytest.approx(300.0 / summary["wall_seconds"])

    def test_pulses_are_those_on_the_bus(self, summary, concluded):
        fired = [0, 0, 0]
        for entry in read_log(concluded / run_dir.BUS_LOG):
            if entry.frame.can_id == CoilFire.ID:
                fired[CoilFire.decode(entry.frame.data).coil] += 1
        assert summary["pulses"] == {"total": sum(fired), "per_coil": fired, "refused": 0}
        assert sum(fired) >= 2
        assert summary["max_pulse_s"] == 3.0
        assert summary["min_gap_s"]["any"] >= 100.0
        assert summary["limits_ok"] is True
        assert summary["duty"]["total"] == pytest.approx(3.0 * sum(fired) / 299.0, rel=0.02)

    def test_angles_are_those_of_the_truth(self, summary, concluded):
        """By scipy: the angle of the rotation, and of axis 1 against the vertical."""
        q = read_truth(concluded / run_dir.TRUTH)["q_body_from_orbit"]
        turn = Rotation.from_quat(q, scalar_first=True)
        angle, tilt = np.degrees(turn.magnitude()), np.degrees(np.arccos(turn.as_matrix()[:, 0, 0]))
        for key, expected in (("pointing_deg", angle), ("axis1_deg", tilt)):
            assert summary[key]["final"] == pytest.approx(expected[-1], rel=1e-9)
            assert summary[key]["rms_last_orbit"] == pytest.approx(np.sqrt(np.mean(expected**2)), rel=1e-9)
            assert summary[key]["max_last_orbit"] == pytest.approx(expected.max(), rel=1e-9)
        assert summary["axis1_deg"]["mean_last_orbit"] == pytest.approx(tilt.mean(), rel=1e-9)

    def test_events_and_mode(self, summary):
        assert [event["node"] for event in summary["events"]] == ["FSW"] * len(summary["events"])
        assert summary["events"][0] == {
            "t_s": 0.0,
            "node": "FSW",
            "event": 2,
            "name": "FILTER_STARTED",
            "severity": 0,
            "severity_name": "INFO",
            "argument": 0,
            "text": "filter started",
        }
        changes = [event["argument"] for event in summary["events"] if event["event"] == 1]
        assert summary["mode_final"] == Mode(changes[-1]).name

    def test_a_flight_without_a_fault_has_isolated_no_unit(self, summary):
        assert summary["isolated"] == []

    def test_what_makes_no_sense_is_absent(self, summary):
        """Five minutes are too short to converge, and no spin is wanted."""
        assert not {"estimate_deg", "converged_at_s", "nees_mean", "spin_radps"} & set(summary)

    def test_how_the_flight_code_ran_is_told(self, summary, concluded):
        assert summary["code"] == standing().code == run_dir.read_run(concluded)["code"]

    def test_the_replay_that_was_made_on_the_way_is_told(self, summary):
        assert summary["replay"] == {"bit_exact": True, "command_exact": True, "ticks": 300}

    def test_the_text_for_people(self, summary):
        text = summary_text(summary)
        assert text.startswith("microsat, seed 5: 300 s flown at ")
        for part in ("kept", "pulses", "deg RMS", "off the vertical, not settled", "no unit", "bit-exact"):
            assert part in text
        assert summary["mode_final"] in text
        assert "spin" not in text

    def test_the_text_tells_how_honest_the_estimate_is_and_what_was_isolated(self, summary):
        error = {"rms_sunlit": 0.041, "max": 0.3, "within_3sigma": 0.9876}
        found = {"estimate_deg": error, "converged_at_s": 12.0, "isolated": ["coil 1", "sun sensor"]}
        text = summary_text(summary | found)
        assert "inside its 3 sigma 98.8% of the time, converged at 12 s" in text
        assert "isolated   coil 1, sun sensor" in text
        unknown = summary_text(summary | found | {"estimate_deg": error | {"within_3sigma": None}})
        assert "0.041 deg RMS sunlit, 0.300 deg max, converged at 12 s" in unknown

    def test_the_text_tells_settling_and_spin_where_there_are_some(self, summary):
        axis1 = summary["axis1_deg"] | {"settle_orbits_5deg": 1.594}
        spin = {"reference": 0.02, "mean_last_orbit": 0.019871, "max_dev_last_orbit": 0.000312}
        text = summary_text(summary | {"axis1_deg": axis1, "spin_radps": spin, "orbits": 3.0})
        assert "under 5 deg from 1.59 orbits on" in text
        assert "0.01987 rad/s in the mean of the last orbit, 0.00031 at most off 0.02" in text


def test_the_summary_of_an_older_version_is_told_too(summary):
    """It has no requirements, and does not say what is controlled."""
    newer = ("requirements", "controlled", "orbits")
    older = {key: value for key, value in summary.items() if key not in newer}
    older["min_gap_s"] = {key: summary["min_gap_s"][key] for key in ("per_coil", "any")}
    text = summary_text(older)
    assert "deg RMS over the last orbit" in text
    assert "least gap" in text
    assert "required" not in text
