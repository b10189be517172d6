"""The result of ``torquer design`` as text and as JSON."""

from math import isfinite, log, pi
from typing import Any

from sim.design.analysis import Analysis, Integral, Pulsed
from sim.design.theory.floquet import NEUTRAL, settling_orbits
from sim.design.theory.linear import Gains, Number
from sim.design.theory.search import MARGIN, Candidate
from sim.scenario.schema import Scenario
from sim.value_types import Json

Range = tuple[float | None, float | None]

NOISE = 1e-12
"""Multipliers of a lesser modulus are rounding noise."""


def as_json(analysis: Analysis) -> Json:
    """The analysis as values of JSON; what does not apply is null or absent."""
    body, found, pulsed = analysis.body, analysis.search, analysis.pulsed
    values: Json = {
        "scenario": body.name,
        "inertia_kgm2": body.inertia_kgm2,
        "altitude_km": body.altitude_km,
        "inclination_deg": body.inclination_deg,
        "gains": _gains(analysis.chosen.gains),
        "degree_of_stability": analysis.chosen.degree,
        "multipliers": [[value.real, value.imag] for value in analysis.multipliers.tolist()],
        "settling_orbits": analysis.settling_orbits,
        "stabilised": analysis.stabilised,
        "degree_of_stability_gains_off": analysis.chosen.worst_degree,
        "gains_off": MARGIN,
        "margins": {
            "k_w_factor": analysis.margins.k_w,
            "k_a_factor": analysis.margins.k_a,
            "both_factor": analysis.margins.both,
            "both_factor_half_degree": analysis.margins.half,
            "moments": analysis.margins.moments,
            "mass_spreads": analysis.margins.spreads,
            "tilt_deg": analysis.margins.tilt_deg,
        },
        "integral": _integral(analysis.integral),
        "periodic_lqr": {"degree_of_stability": analysis.periodic_lqr},
        "resting_torque_nm": analysis.resting_torque_nm.tolist(),
    }
    if found is not None:
        values["steady"] = _candidate(found.steady)
    if pulsed is not None:
        values["pulsed"] = _pulsed_json(pulsed)
    finite: Json = _finite(values)
    return finite


def _finite(value: Any) -> Any:  # noqa: ANN401  (any value of JSON)
    """The same with null for what JSON has no number for: an infinite degree."""
    match value:
        case dict():
            return {key: _finite(one) for key, one in value.items()}
        case list() | tuple():
            return [_finite(one) for one in value]
        case float() if not isfinite(value):
            return None
    return value


def as_text(analysis: Analysis, scenario: Scenario) -> str:
    """The analysis as text."""
    parts = (
        _subject(analysis),
        _verdict(analysis),
        _gain_table(analysis),
        _exponents(analysis),
        _margins(analysis),
        _extensions(analysis),
        _notes(analysis, scenario),
    )
    return "\n\n".join(part for part in parts if part)


def _subject(analysis: Analysis) -> str:
    body = analysis.body
    moments = "/".join(f"{body.inertia_kgm2[i][i]:g}" for i in range(3))
    return (
        f"{body.name}: J {moments} kg m^2, {body.altitude_km:.1f} km, {body.inclination_deg:.2f} deg; "
        f"circular orbit, direct dipole\n"
        f"m = -b x (k_w Omega + k_a S + k_i integral of S dt), S = 2 theta near zero"
    )


def _verdict(analysis: Analysis) -> str:
    """For a search that found nothing: that no gains stabilise."""
    found = analysis.search
    if found is None or found.stabilised:
        return ""
    best = found.best
    sharp = (
        f", and off by {MARGIN:.0%} they give {best.worst_degree:+.3f}: "
        "a strip that no model of the field hits"
        if best.degree < -NEUTRAL
        else ""
    )
    text = (
        f"no gains stabilise this body: the best degree of stability found is {best.degree:+.4f} at "
        f"k_w {best.gains.k_w:.4g}, k_a {best.gains.k_a:.4g}{sharp}"
    )
    if analysis.periodic_lqr is not None and analysis.periodic_lqr < -NEUTRAL:
        text += f"\na periodic regulator does, with a degree of {analysis.periodic_lqr:+.3f}"
    return text


def _gain_table(analysis: Analysis) -> str:
    rows = [("gains", "k_w N m s/T^2", "k_a N m/T^2", "degree", f"off {MARGIN:.0%}", "5 % after")]
    pulsed = analysis.pulsed.search if analysis.pulsed is not None else None
    if analysis.search is None:
        rows.append(_row("given", analysis.chosen))
    for name, found in (("", analysis.search), ("pulses: ", pulsed)):
        if found is not None:
            rows += [_row(f"{name}best", found.best), _row(f"{name}steady", found.steady)]
    return "\n".join("{:<15} {:>14} {:>13} {:>9} {:>9} {:>13}".format(*row) for row in rows)


def _row(name: str, one: Candidate) -> tuple[str, str, str, str, str, str]:
    orbits = settling_orbits(one.degree)
    return (
        name,
        f"{one.gains.k_w:.6g}",
        f"{one.gains.k_a:.6g}",
        f"{one.degree:+.4f}",
        f"{one.worst_degree:+.4f}",
        "never" if orbits is None else f"{orbits:.2f} orbits",
    )


def _exponents(analysis: Analysis) -> str:
    rows = ["multipliers of the first row, |multiplier| and ln|multiplier| / 2 pi:"]
    for value in analysis.multipliers.tolist():
        modulus = abs(value)
        exponent = f"{log(modulus) / (2.0 * pi):+.4f}" if modulus > NOISE else "below noise"
        rows.append(f"  {value.real:+.6e} {value.imag:+.6e} i   {modulus:.4e}   {exponent}")
    return "\n".join(rows)


def _margins(analysis: Analysis) -> str:
    given = analysis.margins
    if not analysis.chosen.degree < -NEUTRAL:
        return "the first row is not stable: it has no margins"
    return "\n".join(
        (
            "the first row stays stable while, alone,",
            f"  k_w {_range(given.k_w)}; k_a {_range(given.k_a)}; both {_range(given.both)} "
            f"(and keep half their degree {_range(given.half)})",
            f"  moments of inertia are off by less than {_percent(given.moments)}, spreads of mass by less "
            f"than {_percent(given.spreads)}, the principal axes by less than {_degrees(given.tilt_deg)}",
        )
    )


def _extensions(analysis: Analysis) -> str:
    integral, pulsed = analysis.integral, analysis.pulsed
    k_i = _number(integral.gains.k_i)
    rows = [f"with an integral of S, k_i {k_i} N m/(T^2 s): {integral.degree:+.4f} (9 states)"]
    if analysis.periodic_lqr is not None:
        rows.append(f"periodic regulator (LQR): {analysis.periodic_lqr:+.4f}")
    if pulsed is not None:
        pulsing = pulsed.pulsing
        ways = ("one coil a pulse, in turn", "all coils in each pulse")
        k_i_pulsed = _number(pulsed.integral.gains.k_i)
        held = "these gains" if pulsed.search is None else "pulses: steady"
        own, other = ways if pulsing.in_turn else ways[::-1]
        rows += [
            f"pulses of {pulsing.pulse_s:g} s every {pulsing.pulse_s + pulsing.backoff_s:g} s, "
            f"taken as {pulsed.periods} an orbit, owed impulses forgotten in {pulsing.leak_s:g} s:",
            f"  averaged {pulsed.averaged:+.4f} (with the law's own dipole, not raised by "
            f"{1.0 / pulsing.duty:.1f}: {pulsed.unraised:+.4f})",
            f"  sampled {pulsed.sampled:+.4f} ({own}); {pulsed.other:+.4f} ({other})",
            f"  {held} with an integral of S, k_i {k_i_pulsed}: {pulsed.integral.degree:+.4f}",
        ]
    return "\n".join(rows)


def _notes(analysis: Analysis, scenario: Scenario) -> str:
    """Notes on the scenario."""
    rows = []
    if max(abs(torque) for torque in analysis.resting_torque_nm.tolist()) > 0.0:
        torque = ", ".join(f"{part:.2e}" for part in analysis.resting_torque_nm.tolist())
        rows.append(
            f"note: the nominal attitude is no equilibrium of this body ({torque} N m on it); "
            f"exponents are those of the equations linearised about it nonetheless"
        )
    if scenario.control.law != "pd":
        law = scenario.control.law_name
        rows.append(f"note: the scenario flies the law {law}; these gains are those of pd")
    if scenario.orbit.tle is not None:
        rows.append("note: of the TLE, mean motion and inclination count")
    return "\n".join(rows)


def _gains(gains: Gains) -> Json:
    return {"k_w": float(gains.k_w), "k_a": float(gains.k_a)}


def _candidate(one: Candidate) -> Json:
    return {
        "gains": _gains(one.gains),
        "degree_of_stability": one.degree,
        "degree_of_stability_gains_off": one.worst_degree,
    }


def _integral(one: Integral) -> Json:
    return {"gains": {**_gains(one.gains), "k_i": _float(one.gains.k_i)}, "degree_of_stability": one.degree}


def _pulsed_json(pulsed: Pulsed) -> Json:
    pulsing = pulsed.pulsing
    in_turn, together = (pulsed.sampled, pulsed.other) if pulsing.in_turn else (pulsed.other, pulsed.sampled)
    values: Json = {
        "pulse_s": pulsing.pulse_s,
        "backoff_s": pulsing.backoff_s,
        "leak_s": pulsing.leak_s,
        "periods_per_orbit": pulsed.periods,
        "averaged": pulsed.averaged,
        "averaged_unraised": pulsed.unraised,
        "sampled": pulsed.sampled,
        "sampled_in_turn": in_turn,
        "sampled_together": together,
        "integral": _integral(pulsed.integral),
    }
    if pulsed.search is not None:
        values["best"], values["steady"] = _candidate(pulsed.search.best), _candidate(pulsed.search.steady)
    return values


def _float(value: Number | None) -> float | None:
    return None if value is None else float(value)


def _number(value: Number | None) -> str:
    return "none" if value is None else f"{float(value):.4g}"


def _range(factors: Range) -> str:
    down, up = factors
    low = "x 0.01 or less" if down is None else f"x {down:.2f}"
    high = "x 100 or more" if up is None else f"x {up:.2f}"
    return f"{low} to {high}"


def _percent(part: float | None) -> str:
    return "50 % or more" if part is None else f"{100.0 * part:.2g} %"


def _degrees(angle_deg: float | None) -> str:
    return "45 deg or more" if angle_deg is None else f"{angle_deg:g} deg"
