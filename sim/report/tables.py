"""Words and tables of the report as values: verdicts, key figures, scenario, events, violations."""

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

import tomli_w

from fsw.core.orbit.tle import read_tle, tle_elements
from fsw.input.own_code import display
from fsw.wire.messages import Mode
from sim.audit.auditor import AuditReport
from sim.audit.findings import COILS, seconds_text
from sim.drawing.page_parts import Table, Tile
from sim.flight.second_senders import describe_senders
from sim.record.run_record import RunRecord
from sim.scenario.schema import Scenario, orbit_period_s

Json = dict[str, Any]
Pairs = list[tuple[str, str]]
"""Names and values."""


VIOLATIONS_SHOWN = 50
EVENTS_OPEN = 12
"""More events than these are folded away."""

_TILES = (
    ("Pointing", ("pointing_deg", "rms_last_orbit"), "{:.2f}°", "RMS, last orbit"),
    ("Axis 1 from vertical", ("axis1_deg", "rms_last_orbit"), "{:.2f}°", "RMS, last orbit"),
    ("Attitude estimate", ("estimate_deg", "rms_sunlit"), "{:.3f}°", "RMS in sunlight"),
    ("Duty", ("duty", "total"), "{:.2%}", "all coils, whole flight"),
    ("Pulses", ("pulses", "total"), "{:d}", "of all coils"),
)
_ATTITUDE = (
    ("Pointing, RMS over the last orbit", ("pointing_deg", "rms_last_orbit"), "{:.3f}°"),
    ("Pointing, largest over the last orbit", ("pointing_deg", "max_last_orbit"), "{:.3f}°"),
    ("Pointing at the end", ("pointing_deg", "final"), "{:.3f}°"),
    ("Axis 1, RMS over the last orbit", ("axis1_deg", "rms_last_orbit"), "{:.3f}°"),
    ("Axis 1, mean over the last orbit", ("axis1_deg", "mean_last_orbit"), "{:.3f}°"),
    ("Axis 1, largest over the last orbit", ("axis1_deg", "max_last_orbit"), "{:.3f}°"),
    ("Axis 1, under 5° from orbit", ("axis1_deg", "settle_orbits_5deg"), "{:.2f}"),
    ("Final mode", ("mode_final",), "{}"),
)
_ESTIMATE = (
    ("Estimate, RMS in sunlight", ("estimate_deg", "rms_sunlit"), "{:.4f}°"),
    ("Estimate, RMS in eclipse", ("estimate_deg", "rms_eclipse"), "{:.4f}°"),
    ("Estimate, largest", ("estimate_deg", "max"), "{:.4f}°"),
    ("Estimate converged at", ("converged_at_s",), "{:.0f} s"),
    ("Estimate inside its 3 sigma", ("estimate_deg", "within_3sigma"), "{:.2%} of the time"),
    ("NEES, mean (6 expected)", ("nees_mean",), "{:.2f}"),
)
_FLIGHT = (
    ("Flown", ("sim_seconds",), "{:.0f} s"),
    ("Ticks", ("ticks",), "{:d}"),
    ("Speed", ("realtime_factor",), "{:.0f} × real time"),
    ("Slips", ("slips",), "{:d}"),
)
_KNOWLEDGE = {"filter": "filter on the sensors", "perfect": "perfect, from the plant"}


def badges(summary: Json, run: RunRecord | None, audit: AuditReport) -> list[tuple[str, str]]:
    """The verdicts with their classes of style: limits, refusals, replay, mode, isolation, completeness."""
    shown = [_limits_badge(audit)]
    refused = summary["pulses"]["refused"]
    shown.append(("note", f"! {refused} refused") if refused else ("good", "✓ no refusals"))
    shown.append(_replay_badge(summary.get("replay")))
    mode = summary.get("mode_final")
    if mode is not None:
        shown.append(("good" if mode == Mode.POINT.name else "note", f"mode {mode}"))
    if summary["isolated"]:
        shown.append(("note", f"! isolated: {', '.join(summary['isolated'])}"))
    if not whole(run, audit):
        planned = f" of {run['ticks']}" if run else ""
        shown.append(("bad", f"✗ incomplete: {summary['ticks']}{planned} ticks"))
    if summary.get("second_senders"):
        shown.append(("bad", f"✗ {describe_senders(summary['second_senders'])}"))
    return shown


def whole(run: RunRecord | None, audit: AuditReport) -> bool:
    """The flight ran to its end, and its log is whole."""
    return audit.complete and (run is None or "flown" in run)


def tiles(summary: Json) -> list[Tile]:
    """The few figures that are looked at first."""
    return [
        Tile(name, _value(summary, keys, pattern), note)
        for name, keys, pattern, note in _TILES
        if _has(summary, keys)
    ]


def key_figures(summary: Json) -> tuple[Pairs, Pairs]:
    """All figures of the summary in two columns: of the attitude; of estimate and flight."""
    return _present(summary, _ATTITUDE), _present(summary, (*_ESTIMATE, *_FLIGHT))


def coil_table(summary: Json, audit: AuditReport) -> Table:
    """Pulses, duty and least gap of each coil and of all, with their limits."""
    limits, duty, gap = audit.limits, summary["duty"], summary["min_gap_s"]
    rows = [
        (f"coil {coil}", str(count), f"{duty_of:.2%}", _seconds(gap_of))
        for coil, count, duty_of, gap_of in zip(
            COILS, summary["pulses"]["per_coil"], duty["per_coil"], gap["per_coil"], strict=True
        )
    ]
    total = ("all", str(summary["pulses"]["total"]), f"{duty['total']:.2%}", _seconds(gap["any"]))
    most_duty = f"≤ {limits.pulse_us / (limits.pulse_us + limits.backoff_us):.2%}"
    least_gap = f"≥ {limits.backoff_us / 1e6:g}"
    rows += (
        [total, ("limit of all", "", most_duty, least_gap)]
        if limits.shared
        else [("limit of each", "", most_duty, least_gap), total]
    )
    return Table(("", "pulses", "duty", "least gap [s]"), rows)


def longest_pulse(summary: Json, audit: AuditReport) -> str:
    """The longest pulse against its limit; empty without a pulse."""
    if summary.get("max_pulse_s") is None:
        return ""
    return f"Longest pulse {summary['max_pulse_s']:.3f} s of {audit.limits.pulse_us / 1e6:g} s."


def scenario_in_words(scenario: Scenario) -> tuple[Pairs, Pairs]:
    """What was flown, in two columns: of orbit and body; of coils, sensors and law."""
    coils, control = scenario.coils, scenario.control
    magnetometer, disturbance = scenario.sensors.magnetometer, scenario.disturbance
    left = [
        ("Orbit", _orbit(scenario)),
        ("Epoch", f"{datetime.fromtimestamp(scenario.epoch_unix_s, UTC):%Y-%m-%d %H:%M:%S} UTC"),
        ("Geomagnetic field", _field(scenario)),
        ("Inertia", f"{_inertia(scenario)} kg m²"),
        ("Start", f"{scenario.initial.angle_deg:g}° about {_triple(scenario.initial.axis)}"),
        ("Start rate", f"{_triple(scenario.initial.rate_degps)} °/s"),
        ("Bias torque", f"{_triple(disturbance.torque_nm)} N m"),
        ("Residual dipole", f"{_triple(disturbance.residual_dipole_am2)} A m²"),
    ]
    right = [
        ("Levels", f"{_triple(coils.levels_am2)} A m², both polarities"),
        ("Limits", f"{coils.pulse_s:g} s pulses, {coils.backoff_s:g} s back-off, {_backoff(coils.shared)}"),
        ("Knowledge", _KNOWLEDGE[scenario.knowledge]),
        ("Magnetometer", f"{magnetometer.noise_nt:g} nT noise, bias {_triple(magnetometer.bias_nt)} nT"),
        ("Sun sensor", f"{scenario.sensors.sun.noise_deg:g}° noise"),
        ("Law", f"{display(control.law)}, k_w {control.k_w:g} N m s/T², k_a {control.k_a:g} N m/T²"),
        ("Tick rate", f"{scenario.time.tick_hz} Hz"),
    ]
    return left, right


def scenario_toml(scenario: Scenario) -> str:
    """The scenario in full."""
    return tomli_w.dumps(scenario.model_dump(mode="json", exclude_none=True))


def violations(audit: AuditReport) -> Table:
    """The first of the limits that were broken."""
    rows = [
        (seconds_text(one.time_s), "" if one.coil is None else str(one.coil), one.kind, one.sentence)
        for one in audit.violations[:VIOLATIONS_SHOWN]
    ]
    return Table(("t [s]", "coil", "limit", "what"), rows, "Limits broken")


def versions(run: RunRecord | None) -> Sequence[str]:
    """What wrote the run, for the foot of the page."""
    if run is None:
        return ("torquer",)
    platform = run["platform"]
    return (
        f"torquer {run['torquer_version']}",
        f"scenario {run['scenario_sha256'][:12]}",
        f"flight table {run['flight_table_crc']}",
        f"Python {platform['python']}, numpy {platform['numpy']}",
        f"{platform['system']} {platform['machine']}",
    )


def _limits_badge(audit: AuditReport) -> tuple[str, str]:
    if audit.ok:
        return "good", "✓ limits kept"
    if not audit.violations:
        return "note", "! limits not judged: no coil status"
    return "bad", f"✗ limits broken: {len(audit.violations)}"


def _replay_badge(replay: Json | None) -> tuple[str, str]:
    if replay is None:
        return "note", "not replayed"
    if replay["bit_exact"]:
        return "good", "✓ replay bit-exact"
    return ("note", "! replay command-exact only") if replay["command_exact"] else ("bad", "✗ replay differs")


def _orbit(scenario: Scenario) -> str:
    orbit = scenario.orbit
    period = f"{orbit_period_s(scenario) / 60.0:.1f} min"
    if orbit.tle is not None:
        satellite, elements = read_tle(*orbit.tle).satnum_str.strip(), tle_elements(*orbit.tle)
        return f"elements of {satellite}, inclination {elements.inclination_deg:.2f}°, {period}"
    return f"circular, {orbit.altitude_km:g} km, inclination {orbit.inclination_deg:g}°, {period}"


def _field(scenario: Scenario) -> str:
    field = scenario.field
    return f"igrf14, degree {field.degree}" if field.model == "igrf14" else field.model.replace("_", " ")


def _inertia(scenario: Scenario) -> str:
    tensor = scenario.body.inertia
    if all(tensor[i][j] == 0.0 for i in COILS for j in COILS if i != j):
        return _triple([tensor[i][i] for i in COILS])
    return ", ".join(_triple(row) for row in tensor)


def _backoff(shared: bool) -> str:
    return "shared by all coils" if shared else "each coil its own"


def _triple(values: Iterable[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"


def _seconds(value: float | None) -> str:
    return "–" if value is None else seconds_text(value)


def _find(summary: Json, keys: Sequence[str]) -> Any:  # noqa: ANN401  (any part of it)
    found: Any = summary
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def _has(summary: Json, keys: Sequence[str]) -> bool:
    return _find(summary, keys) is not None


def _value(summary: Json, keys: Sequence[str], pattern: str) -> str:
    return pattern.format(_find(summary, keys))


def _present(summary: Json, rows: Sequence[tuple[str, Sequence[str], str]]) -> Pairs:
    return [(name, _value(summary, keys, pattern)) for name, keys, pattern in rows if _has(summary, keys)]
