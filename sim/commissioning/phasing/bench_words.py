"""The response of a bench log in words and as JSON, and what it cannot tell."""

from math import isnan
from statistics import median

import numpy as np

from sim.commissioning.phasing.bench_log import SIGMAS, BenchResponse
from sim.commissioning.phasing.bench_steps import WEAK_SIGMAS, Step
from sim.value_types import Json

LINEAR_PART = 0.15
"""How far a response may be off proportion to its command, in parts of the largest."""


INCONCLUSIVE = (
    "No axis is determined: the log has neither the field around nor how coils and magnetometers are turned."
)


def lines(responses: list[BenchResponse]) -> list[str]:
    """The response by magnetometer and command, then what is not determined."""
    text = []
    for one in responses:
        text.append(f"{one.name}: {_idle(one)}")
        text += [_step_line(step) for step in one.steps]
        text += [f"  {sentence}" for sentence in findings(one)]
    return [*text, INCONCLUSIVE]


def _idle(one: BenchResponse) -> str:
    """Noise and drift without a command."""
    if np.isnan(one.noise_nt).any():
        return "no readings without a command: neither noise nor drift is determined"
    noise = " ".join(f"{part / 1000.0:.3f}" for part in one.noise_nt)
    drift = " ".join(f"{part / 1000.0:+.1f}" for part in one.drift_nt)
    return f"noise {noise} uT, drift over the log {drift} uT (x y z)"


def _step_line(step: Step) -> str:
    command = " ".join(f"{1000.0 * part:6.2f}" for part in step.command_am2)
    by_axis = zip(step.response_nt, step.sigma_nt, strict=True)
    response = " ".join(f"{value / 1000.0:+8.3f} ±{sigma / 1000.0:.3f}" for value, sigma in by_axis)
    if isnan(step.changed_s):
        phase = "too weak for its phase"
    else:
        phase = f"shows {step.unchanged_s:.2f} to {step.changed_s:.2f} s after the command"
    return f"  {command} mA m^2: {response} uT, {step.edges} edges, {phase}"


def findings(one: BenchResponse) -> list[str]:
    """What else the readings show."""
    found = [f"{tied} in every sample: not an axis of its own" for tied in one.tied]
    found += _phase(one)
    for axis, letter in enumerate("xyz"):
        levels = [step for step in one.steps if np.flatnonzero(step.command_am2).tolist() == [axis]]
        off = _off_proportion(levels, axis)
        if off > LINEAR_PART:
            percent = 100.0 * off
            found.append(
                f"not proportional to a command along {letter}: off by {percent:.0f} % of the largest"
            )
        for other in _reverses(levels, axis):
            found.append(f"the response of {other} to a command along {letter} reverses with its level")
    return found


def _phase(one: BenchResponse) -> list[str]:
    """When the response comes, of the commands to which it is clear."""
    if not one.steps:
        return [
            "no command that begins or ends at zero has settled readings on both sides: nothing to compare"
        ]
    clear = [step for step in one.steps if not isnan(step.changed_s)]
    if not clear:
        return [f"responds to no command by {WEAK_SIGMAS:.0f} standard deviations: no phase is determined"]
    unchanged_s = median(step.unchanged_s for step in clear)
    changed_s = median(step.changed_s for step in clear)
    if unchanged_s <= one.cycle_s:
        return [f"in phase with the command, within {one.latest_s():.2f} s; the log tells it no closer"]
    return [
        f"late: {unchanged_s:.2f} to {changed_s:.2f} s after the command, with a reading every "
        f"{one.cycle_s:.2f} s"
    ]


def _off_proportion(levels: list[Step], axis: int) -> float:
    """How far the responses are off a line through zero, in parts of the largest, beyond the noise."""
    if len(levels) < 2:
        return 0.0
    m = np.array([step.command_am2[axis] for step in levels])
    response = np.array([step.response_nt for step in levels])
    slope = m @ response / (m @ m)
    off = np.linalg.norm(response - np.outer(m, slope), axis=1)
    sigma = np.array([np.linalg.norm(step.sigma_nt) for step in levels])
    largest = float(np.linalg.norm(response, axis=1).max())
    return float(np.max(np.where(off > SIGMAS * sigma, off, 0.0))) / largest if largest > 0.0 else 0.0


def _reverses(levels: list[Step], along: int) -> list[str]:
    """Axes along which clear responses to one sense of a command along an axis have both signs."""
    found = []
    for axis, letter in enumerate("xyz"):
        clear = [s for s in levels if abs(s.response_nt[axis]) > SIGMAS * s.sigma_nt[axis]]
        signs = {(s.command_am2[along] > 0.0, bool(s.response_nt[axis] > 0.0)) for s in clear}
        if {(True, True), (True, False)} <= signs or {(False, True), (False, False)} <= signs:
            found.append(letter)
    return found


def as_json(responses: list[BenchResponse]) -> Json:
    """The same as values."""
    return {
        "magnetometers": {
            one.name: {
                "noise_nt": one.noise_nt.tolist(),
                "drift_nt": one.drift_nt.tolist(),
                "cycle_s": one.cycle_s,
                "tied": list(one.tied),
                "findings": findings(one),
                "steps": [
                    {
                        "command_am2": list(step.command_am2),
                        "response_nt": step.response_nt.tolist(),
                        "sigma_nt": step.sigma_nt.tolist(),
                        "edges": step.edges,
                        "unchanged_s": None if isnan(step.unchanged_s) else step.unchanged_s,
                        "changed_s": None if isnan(step.changed_s) else step.changed_s,
                    }
                    for step in one.steps
                ],
            }
            for one in responses
        },
        "axes_told": False,
    }
