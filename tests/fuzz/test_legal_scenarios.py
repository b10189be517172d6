"""Random legal scenarios fly or are refused in a sentence; what they leave is read and judged the same.

Some short flights, as a rule; ``make scenarios`` flies 300 of one or two orbits, of fewer at high tick rates.
"""

import os
from dataclasses import replace

import h5py
import numpy as np
import pytest

import torquer
from sim.audit.findings import ViolationKind
from sim.faults.section import break_frames, forge_sync
from sim.report import conclude
from sim.scenario.schema import flight_table, orbit_period_s
from sim.scenario.telecommands import SendSpin
from sim.statistics.settling import HELD_S
from sim.testing.legal_scenarios import legal_scenario

pytestmark = [pytest.mark.long, pytest.mark.timeout(600)]

WHOLE = "TORQUER_SCENARIOS" in os.environ
FIRST, PAST = map(int, os.environ.get("TORQUER_SCENARIOS", "0:8").split(":"))
SHORT_TICKS = 700
ROUNDING = 1e-6
"""Of a figure that is computed in two ways."""


def orbits_of(scenario, orbits):
    most = SHORT_TICKS / (orbit_period_s(scenario) * scenario.time.tick_hz)
    return orbits if WHOLE else min(orbits, most)


@pytest.mark.parametrize("number", range(FIRST, PAST))
@pytest.mark.slow
def test_it_flies_and_is_read_and_judged_the_same(number, tmp_path, monkeypatch):
    if number % 8:  # drawing takes longer than a flight
        monkeypatch.setattr(conclude, "write_report", lambda path, *rest: path.write_text(""))
    scenario, orbits = legal_scenario(number)
    path = tmp_path / "run"
    orbits = orbits_of(scenario, orbits)
    run, refusal = flown(scenario, orbits, number, path)
    if run is None:
        assert "\n" not in refusal
        check_cut_short(path, scenario)
        return
    assert run.ended == ""
    read = torquer.load(path)
    assert read.scenario.model_dump() == scenario.model_dump()
    assert read.summary["replay"]["bit_exact"]
    check_limits(read)
    check_requirements(read)
    if number % 4 == 0:
        again, _ = flown(str(path / "scenario.toml"), orbits, number, tmp_path / "again")
        assert again.log.read_bytes() == run.log.read_bytes()
        assert read.replay().ok


def flown(scenario, orbits, number, path):
    """The run, or the sentence of why there is none."""
    try:
        return torquer.fly(scenario, orbits=orbits, seed=number, out=path), ""
    except torquer.Error as refusal:
        return None, str(refusal)


def check_cut_short(path, scenario):
    """It was refused before anything was there, or its motion diverges: then nothing of it is called met."""
    if not path.exists():
        return
    assert torquer.load(path).scenario.model_dump() == scenario.model_dump()
    run = torquer.report(path)
    assert "complete" in run.failures
    assert {one["verdict"] for one in run.summary["requirements"]} <= {"not judged"}


def check_limits(run):
    """The audit of the log gives the verdict of the flight, but for frames that a fault breaks.

    In a log they are violations, as it does not say who broke them; a SYNC that a fault forges may be more.
    """
    report, faults = run.check().report, run.scenario.fault
    if forge_sync(faults):
        assert run.summary["limits_ok"] or not report.ok
        return
    if break_frames(faults):
        by_others = (one for one in report.violations if one.kind is not ViolationKind.FRAME)
        report = replace(report, violations=tuple(by_others))
    assert report.ok == run.summary["limits_ok"]


def check_requirements(run):
    """What is called met is what the truth shows."""
    with h5py.File(run.path / "truth.h5") as file:
        truth = {name: file[name][:] for name in ("q_body_from_orbit", "omega_body_orbit_radps", "lit")}
    stated = zip(run.scenario.requirement, run.summary["requirements"], strict=True)
    for section, judged in stated:
        if judged["verdict"] == "met":
            check_met(run.scenario, truth, section, judged)


def check_met(scenario, truth, section, judged):
    of_what = section.index in ("ape", "settling")
    error = error_of(judged["what"] if of_what else section.index, truth, scenario)
    if error is None or section.index in ("mpe", "rpe", "ake", "duty", "energy"):
        return
    per_orbit = orbit_period_s(scenario) * scenario.time.tick_hz
    ticks = len(error)
    assert ticks + 1 > section.by_orbit * per_orbit
    asked = error_of(judged["what"] or pointed(scenario), truth, scenario)
    threshold = section.settled_degps if judged["what"] == "spin" else section.settled_deg
    out = np.flatnonzero(asked >= threshold + ROUNDING) if asked is not None else np.array([])
    settled = int(out[-1]) + 1 if len(out) else 0
    if section.index == "settling" or section.window == "settled":
        assert ticks - settled >= HELD_S * scenario.time.tick_hz
        assert settled <= section.by_orbit * per_orbit + 1
    if section.index == "settling":
        assert settled <= section.limit * per_orbit * (1.0 + ROUNDING) + ROUNDING
        return
    since = settled if section.window == "settled" else max(0, ticks - round(section.last_orbits * per_orbit))
    values = error[since:]
    if section.sunlit:
        values = values[truth["lit"][since:] > 0.5]
    assert len(values)
    if section.probability is None:
        assert np.sqrt(np.mean(values**2)) <= section.limit * (1.0 + ROUNDING) + ROUNDING
    else:
        inside = np.mean(values <= section.limit * (1.0 + ROUNDING) + ROUNDING)
        assert inside >= section.probability - 1.0 / len(values)


def pointed(scenario):
    """What settles where a requirement is of nothing that is pointed."""
    return "axis" if flight_table(scenario).modes.axis_only else "attitude"


def error_of(what, truth, scenario):
    """The error by tick, deg or deg/s; None where this test does not compute it."""
    q0, q1, q2, q3 = truth["q_body_from_orbit"].T
    if what == "attitude":
        return np.degrees(2.0 * np.arctan2(np.sqrt(q1 * q1 + q2 * q2 + q3 * q3), np.abs(q0)))
    if what == "axis":
        across = np.hypot(2.0 * (q1 * q2 + q0 * q3), 2.0 * (q1 * q3 - q0 * q2))
        return np.degrees(np.arctan2(across, q0 * q0 + q1 * q1 - q2 * q2 - q3 * q3))
    if any(isinstance(one, SendSpin) for one in scenario.telecommand):
        return None
    rate = truth["omega_body_orbit_radps"] - np.array([scenario.control.spin_radps, 0.0, 0.0])
    if what == "spin":
        return np.degrees(np.abs(rate[:, 0]))
    return np.degrees(np.linalg.norm(rate, axis=1)) if what == "rate" else None
