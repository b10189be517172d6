"""summary.json: the performance of a flight, judged against the plant's truth."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsw.wire.messages import CLASSES, NAMES, SENDERS, CoilRefused, FswEvent, Mode, intact
from sim.audit.auditor import AuditReport
from sim.flight.isolations import isolated_unit
from sim.record.candump import LogEntry
from sim.record.estimates import Estimates
from sim.record.run_record import FlightRecord
from sim.record.truth import Histories
from sim.report import parameters
from sim.report.attitude_arrays import angle_rad, axis1_angle_rad, normal_in_body, relative
from sim.report.spans import held_from, spans
from sim.scenario.schema import Scenario, orbit_period_s

Array = NDArray[np.float64]
Json = dict[str, Any]

CONVERGED_DEG = 2.0
CONVERGED_FOR_S = 600.0
SETTLED_DEG = 5.0
SPIN_SETTLED_RADPS = 1e-3
MAX_EVENTS = 200


@dataclass(slots=True)
class BusTally:
    """Refusals on the bus, the first events in full, and the units that were isolated, in that order."""

    epoch_us: int
    refused: int = 0
    events: list[Json] = field(default_factory=list)
    isolated: list[str] = field(default_factory=list)

    def take(self, entry: LogEntry) -> None:
        """Count one frame."""
        can_id = entry.frame.can_id
        if can_id == CoilRefused.ID:
            self.refused += 1
        elif NAMES.get(can_id, "").endswith("_EVENT") and intact(entry.frame):
            self._take_event(entry)

    def _take_event(self, entry: LogEntry) -> None:
        can_id = entry.frame.can_id
        values = CLASSES[can_id].decode(entry.frame.data)._asdict()
        if can_id == FswEvent.ID:
            unit = isolated_unit(values["event"], values["argument"])
            if unit is not None and unit not in self.isolated:
                self.isolated.append(unit)
        if len(self.events) < MAX_EVENTS:
            seconds = (entry.timestamp_us - self.epoch_us) / 1e6
            self.events.append(
                {
                    "t_s": seconds,
                    "node": SENDERS[can_id],
                    "event": values["event"],
                    "severity": values["severity"],
                    "argument": values["argument"],
                }
            )


def summarise(
    scenario: Scenario,
    run: FlightRecord,
    truth: Histories,
    estimates: Estimates,
    audit: AuditReport,
    tally: BusTally,
) -> Json:
    """The content of summary.json, of the keys that apply to this flight."""
    tick_hz = scenario.time.tick_hz
    ticks = len(truth["t_s"])
    sim_s = ticks / tick_hz
    last_orbit = slice(max(0, ticks - round(orbit_period_s(scenario) * tick_hz)), ticks)
    flight = run.get("flown")
    wall_s = flight.get("wall_s") if flight else None
    summary: Json = {
        "scenario": scenario.name,
        "seed": run["seed"],
        "sim_seconds": sim_s,
        "wall_seconds": wall_s,
        "realtime_factor": sim_s / wall_s if wall_s else None,
        "ticks": ticks,
        "slips": flight.get("slips") if flight else None,
        "pulses": {
            "total": len(audit.pulses),
            "per_coil": audit.pulses_per_coil,
            "refused": tally.refused,
        },
        "duty": {"per_coil": audit.duty_per_coil, "total": audit.duty_total},
        "min_gap_s": {"per_coil": audit.min_gap_per_coil_s, "any": audit.min_gap_any_s},
        "max_pulse_s": audit.max_pulse_s,
        "limits_ok": audit.ok,
    }
    if ticks:
        q = truth["q_body_from_orbit"]
        upright = np.zeros_like(q)
        upright[:, 0] = 1.0
        summary["pointing_deg"] = _angles(np.degrees(angle_rad(relative(upright, q))), last_orbit)
        summary["axis1_deg"] = _axis1(np.degrees(axis1_angle_rad(q)), last_orbit, tick_hz, scenario)
        summary |= _estimate(truth, estimates, tick_hz)
        summary["parameters"] = parameters.parameter_figures(scenario, truth, estimates)
        summary["spin_radps"] = _spin(scenario, truth, audit, last_orbit)
        summary["mode_final"] = Mode(int(estimates.mode[ticks - 1])).name
    summary["isolated"] = tally.isolated
    summary["events"] = tally.events
    return {key: value for key, value in summary.items() if value is not None}


def estimate_error(truth: Histories, estimates: Estimates) -> Array:
    """The rotation from the estimated to the true attitude at each tick, (n, 4); NaN before the first."""
    ticks = len(truth["t_s"])
    return relative(estimates.q_body_from_orbit[:ticks], truth["q_body_from_orbit"])


def converged_tick(error_deg: Array, tick_hz: int) -> int | None:
    """The first tick of ten minutes with a small error of the estimate; NaN, no estimate, is not small."""
    length = round(CONVERGED_FOR_S * tick_hz)
    return next((first for first, past in spans(error_deg < CONVERGED_DEG) if past - first >= length), None)


def within_3sigma(truth: Histories, estimates: Estimates) -> NDArray[np.bool_]:
    """Whether each axis of the attitude error is inside the filter's own 3 sigma, by tick, (n, 3), body axes.

    False where the error or its covariance is unknown.
    """
    ticks = len(truth["t_s"])
    error_rad = 2.0 * estimate_error(truth, estimates)[:, 1:]
    variance = np.diagonal(estimates.covariance[:ticks, :3, :3], axis1=1, axis2=2)
    result: NDArray[np.bool_] = np.abs(error_rad) < 3.0 * np.sqrt(variance)
    return result


def nees(truth: Histories, estimates: Estimates) -> Array:
    """Normalised estimation error squared of attitude and rate at each tick; NaN where unknown."""
    ticks = len(truth["t_s"])
    turn = estimate_error(truth, estimates)
    orbit_rate = np.linalg.norm(
        estimates.omega_body_radps[:ticks] - estimates.omega_body_orbit_radps[:ticks], axis=1
    )
    omega_true = truth["omega_body_orbit_radps"] + orbit_rate[:, None] * normal_in_body(
        truth["q_body_from_orbit"]
    )
    error = np.hstack((2.0 * turn[:, 1:], omega_true - estimates.omega_body_radps[:ticks]))
    defined = np.isfinite(error).all(axis=1)
    result = np.full(ticks, np.nan)
    if defined.any():
        solved = np.linalg.solve(estimates.covariance[:ticks][defined], error[defined][:, :, None])[:, :, 0]
        result[defined] = np.sum(error[defined] * solved, axis=1)
    return result


def _angles(angle_deg: Array, last_orbit: slice) -> Json:
    recent = angle_deg[last_orbit]
    return {
        "final": float(angle_deg[-1]),
        "rms_last_orbit": float(np.sqrt(np.mean(recent**2))),
        "max_last_orbit": float(recent.max()),
    }


def _axis1(angle_deg: Array, last_orbit: slice, tick_hz: int, scenario: Scenario) -> Json:
    result = _angles(angle_deg, last_orbit) | {"mean_last_orbit": float(angle_deg[last_orbit].mean())}
    settled = held_from(angle_deg < SETTLED_DEG)
    if settled is not None:
        result["settle_orbits_5deg"] = settled / tick_hz / orbit_period_s(scenario)
    return result


def _estimate(truth: Histories, estimates: Estimates, tick_hz: int) -> Json:
    error_deg = np.degrees(angle_rad(estimate_error(truth, estimates)))
    first = converged_tick(error_deg, tick_hz)
    if first is None:
        return {}
    error_deg, lit = error_deg[first:], truth["lit"][first:] > 0.5
    estimated = np.isfinite(error_deg)  # a filter that starts anew has no estimate for a while
    consistency = nees(truth, estimates)[first:]
    result: Json = {
        "estimate_deg": {
            key: float(np.sqrt(np.mean(error_deg[where] ** 2)))
            for key, where in (("rms_sunlit", lit & estimated), ("rms_eclipse", ~lit & estimated))
            if where.any()
        }
        | {
            "max": float(error_deg[estimated].max()),
            "within_3sigma": _part_within_3sigma(truth, estimates, first),
        },
        "converged_at_s": first / tick_hz,
    }
    if np.isfinite(consistency).any():
        result["nees_mean"] = float(np.nanmean(consistency))
    return result


def _part_within_3sigma(truth: Histories, estimates: Estimates, first: int) -> float | None:
    """Part of the ticks from ``first`` on, attitude valid, with all axes inside; None if no covariance."""
    ticks = len(truth["t_s"])
    known = np.isfinite(estimates.covariance[:ticks]).all(axis=(1, 2))
    counted = (estimates.valid[:ticks] & known)[first:]
    if not counted.any():
        return None
    return float(within_3sigma(truth, estimates)[first:][counted].all(axis=1).mean())


def _spin(scenario: Scenario, truth: Histories, audit: AuditReport, last_orbit: slice) -> Json | None:
    """How the spin about body axis 1 follows its reference; None without a reference."""
    reference = scenario.control.spin_radps
    if reference == 0.0:
        return None
    spin = truth["omega_body_orbit_radps"][:, 0]
    deviation = np.abs(spin - reference)
    result: Json = {
        "reference": reference,
        "mean_last_orbit": float(spin[last_orbit].mean()),
        "max_dev_last_orbit": float(deviation[last_orbit].max()),
    }
    inside = np.flatnonzero(deviation < SPIN_SETTLED_RADPS)
    if len(inside):
        settle_s = int(inside[0]) / scenario.time.tick_hz
        result["settle_s_1e-3"] = settle_s
        result["pulses_to_settle"] = sum(pulse.start_s < settle_s for pulse in audit.pulses)
    return result


def summary_text(summary: Json) -> str:
    """The summary as a few lines of text."""
    pulses, gap_s = summary["pulses"], summary["min_gap_s"]["any"]
    heading = f"{summary['scenario']}, seed {summary['seed']}: {summary['sim_seconds']:.0f} s flown"
    if "realtime_factor" in summary:
        heading += f" at {summary['realtime_factor']:.0f} times real time"
    limits_text = "kept" if summary["limits_ok"] else "BROKEN"
    limits = f"{limits_text}: {pulses['total']} pulses, {pulses['refused']} refused"
    if "max_pulse_s" in summary:
        limits += f", longest {summary['max_pulse_s']:.3f} s"
    if gap_s is not None:
        limits += f", least gap {gap_s:.3f} s"
    rows = {"limits": limits}
    if "pointing_deg" in summary:
        last = summary["pointing_deg"]
        rows["pointing"] = (
            f"{last['rms_last_orbit']:.2f} deg RMS, {last['max_last_orbit']:.2f} deg max over the last orbit"
        )
        axis1 = summary["axis1_deg"]
        settled = axis1.get("settle_orbits_5deg")
        after = f"under 5 deg from {settled:.2f} orbits on" if settled is not None else "not settled"
        rows["axis 1"] = f"{axis1['rms_last_orbit']:.2f} deg RMS off the vertical, {after}"
    if "spin_radps" in summary:
        spin = summary["spin_radps"]
        rows["spin"] = (
            f"{spin['mean_last_orbit']:.5f} rad/s in the mean of the last orbit, "
            f"{spin['max_dev_last_orbit']:.5f} at most off {spin['reference']:g}"
        )
    if "estimate_deg" in summary:
        error = summary["estimate_deg"]
        named = (("rms_sunlit", "RMS sunlit"), ("rms_eclipse", "RMS in eclipse"), ("max", "max"))
        parts = [f"{error[key]:.3f} deg {text}" for key, text in named if key in error]
        if error["within_3sigma"] is not None:
            parts.append(f"inside its 3 sigma {error['within_3sigma']:.1%} of the time")
        rows["estimate"] = f"{', '.join(parts)}, converged at {summary['converged_at_s']:.0f} s"
    if "mode_final" in summary:
        rows["mode"] = summary["mode_final"]
    rows["isolated"] = ", ".join(summary["isolated"]) or "no unit"
    if "replay" in summary:
        rows["replay"] = "bit-exact" if summary["replay"]["bit_exact"] else "NOT bit-exact"
    failed = summary.get("failures", {})
    rows |= {
        name.replace("_", " "): failed[name] for name in ("second_senders", "complete") if name in failed
    }
    return "\n".join([heading, *(f"  {name:<10} {text}" for name, text in rows.items())])
