"""Words and tables of the report as values: key figures, coils, scenario, events, violations."""

from collections.abc import Iterable, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any

import tomli_w

from fsw.core.orbit.tle import read_tle, tle_elements
from fsw.input.own_code import display, given_as
from sim.audit.auditor import AuditReport
from sim.audit.findings import COILS, seconds_text
from sim.drawing.page_parts import Table
from sim.record.run_record import RunRecord
from sim.report.summary import last_orbit
from sim.scenario.schema import Scenario, orbit_period_s
from sim.scenario.written import values_of
from sim.value_types import Json

Pairs = list[tuple[str, str]]
"""Names and values."""


VIOLATIONS_SHOWN = 50
EVENTS_OPEN = 12
"""More events than this are folded away."""

_ATTITUDE = (
    (", RMS over {window}", "rms_last_orbit"),
    (", largest over {window}", "max_last_orbit"),
    (", mean over {window}", "mean_last_orbit"),
    (" at the end", "final"),
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
    ("Flight code", ("code",), "{}"),
)
_KNOWLEDGE = {"filter": "filter on the sensors", "perfect": "perfect, from the plant"}


def key_figures(summary: Json) -> tuple[Pairs, Pairs]:
    """All figures of the summary in two columns: of the attitude; of estimate and flight."""
    return [*_attitude(summary)], _present(summary, (*_ESTIMATE, *_FLIGHT))


def _attitude(summary: Json) -> Iterator[tuple[str, str]]:
    """What is controlled first, with its settling; the whole attitude only where that is controlled."""
    if "controlled" not in summary:
        return
    found, window = summary["controlled"], last_orbit(summary)
    unit = "°" if found["unit"] == "deg" else f" {found['unit']}"
    settled = f"{found['settle_orbits']:.2f} orbits" if "settle_orbits" in found else "not settled"
    yield f"Controlled: {found['words']}, under {found['threshold']:g}{unit} from", settled
    if found["what"] == "rate":
        yield f"Rate, RMS over {window}", f"{found['rms_last_orbit']:.4f} °/s"
    named = (("Pointing", "pointing_deg"), ("Axis 1", "axis1_deg"))
    for name, key in named[found["what"] == "axis" :]:
        for words, figure in _ATTITUDE:
            if figure in summary[key]:
                yield f"{name}{words.format(window=window)}", f"{summary[key][figure]:.3f}°"
    if "mode_final" in summary:
        yield "Final mode", summary["mode_final"]


def coil_table(summary: Json, audit: AuditReport) -> Table:
    """Pulses, duty and least gap of each coil and of all, with their limits."""
    limits, duty, gap = audit.limits, summary["duty"], summary["min_gap_s"]
    rows = [
        (f"coil {coil}", str(count), f"{duty_of:.2%}", _seconds(gap_of))
        for coil, count, duty_of, gap_of in zip(
            COILS, summary["pulses"]["per_coil"], duty["per_coil"], gap["per_coil"], strict=True
        )
    ]
    any_gap = _seconds(gap["any"]) if limits.shared else ""
    total = ("all", str(summary["pulses"]["total"]), f"{duty['total']:.2%}", any_gap)
    most_duty = f"≤ {limits.most_duty(float(audit.span_s)):.2%}"
    least_gap = "" if limits.is_continuous else f"≥ {limits.backoff_us / 1e6:g}"
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
    if given_as(control.law) is not None:
        right.append(("Replay", "only by whoever has the law, which was given as an object"))
    return left, right


def scenario_toml(scenario: Scenario) -> str:
    """The scenario in full."""
    return tomli_w.dumps(values_of(scenario))


def violations(audit: AuditReport) -> Table:
    """The first violations of the limits."""
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


def find(summary: Json, keys: Sequence[str]) -> Any:  # noqa: ANN401  (any part of it)
    """A part of the summary; None if it has none."""
    found: Any = summary
    for key in keys:
        found = found.get(key) if isinstance(found, dict) else None
    return found


def has(summary: Json, keys: Sequence[str]) -> bool:
    """Whether the summary has that part."""
    return find(summary, keys) is not None


def value(summary: Json, keys: Sequence[str], pattern: str) -> str:
    """A part of the summary, formatted."""
    return pattern.format(find(summary, keys))


def _present(summary: Json, rows: Sequence[tuple[str, Sequence[str], str]]) -> Pairs:
    return [(name, value(summary, keys, pattern)) for name, keys, pattern in rows if has(summary, keys)]
