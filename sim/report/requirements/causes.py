"""Why a requirement is missed: a table of causes, each a pure function of what is known of the flight."""

from collections.abc import Callable, Sequence
from math import exp, inf, log
from typing import NamedTuple

import numpy as np

from fsw.table.estimator import table_bounds
from fsw.table.uncertainty import UncertaintyTable
from fsw.table.uncertainty import bounds as ordinary_bounds
from fsw.wire.messages import Mode
from sim.design.from_scenario import body_of, pulsing_of
from sim.design.theory.floquet import NEUTRAL, degree_of_stability, monodromy
from sim.design.theory.linear import Gains, closed_loop
from sim.design.theory.pulsed import PulsedLoop
from sim.report.requirements.evidence import FlightEvidence, Missed
from sim.report.requirements.sizing import balance, gradient_level_am2, least_error_deg, pulse_turn_deg
from sim.report.requirements.words import number, orbits, part
from sim.scenario.schema import Scenario, flight_table
from sim.sizing.deviations import deviations
from sim.sizing.gravity import gravity_on, gravity_words
from sim.sizing.levels import TOO_WEAK

# --- Where the satellite of a scenario differs from its onboard table by more than the bounds of that table

SHOWN = 3
BEYOND = 1.2
"""A deviation above this many times its bound is stated, if it is more than ordinary for such a satellite."""


def beyond_bounds(scenario: Scenario, misled: bool = False) -> list[str]:
    """Its deviations beyond their bounds, a clause each, the worst first; at most ``SHOWN``.

    Args:
        scenario: the satellite, and its onboard table.
        misled: the estimate was; then what is ordinary for such a satellite counts, too, beyond its bound.
    """
    table = flight_table(scenario)
    albedo = table.cells.albedo if table.cells else None
    usual = ordinary_bounds(UncertaintyTable(), table.ordinary, albedo)
    found = []
    for one, ordinary in zip(
        deviations(scenario, table_bounds(table)), deviations(scenario, usual), strict=True
    ):
        least = max(BEYOND * one.bound, one.slight, 0.0 if misled else ordinary.bound)
        if one.worst > least:
            found.append((one.worst / least, one.words))
    return [clause for _, clause in sorted(found, reverse=True)[:SHOWN]]


# --- Why a flight settled late: causes from its course

MOST_NAMED = 3
FALLS = 0.9
"""An error falls if it is at most this fraction of itself an orbit earlier."""


def fell_back(missed: Missed, evidence: FlightEvidence) -> str:
    """The controller went back to damp rates, or to SAFE, after it had known the attitude."""
    falls = [
        f"{mode.name} from {orbits(at)} on for {orbits(length)}" for mode, at, length in evidence.fell_back
    ]
    more = f" and {len(falls) - MOST_NAMED} times more" if len(falls) > MOST_NAMED else ""
    return f"the controller fell back to {', to '.join(falls[:MOST_NAMED])}{more}" if falls else ""


def left_again(missed: Missed, evidence: FlightEvidence) -> str:
    """The error had been small, and grew again."""
    under = [place for place, error in enumerate(evidence.course) if missed.limit and error < missed.limit]
    if missed.limit is None or not under:
        return ""
    worst = max(range(under[0], len(evidence.course)), key=lambda place: evidence.course[place])
    if evidence.course[worst] < missed.limit:
        return ""
    unit = _unit(missed)
    return (
        f"it was under {number(missed.limit)} {unit} at {orbits(under[0] / 2.0)} and left it again: "
        f"{number(evidence.course[worst])} {unit} RMS in the half orbit from {orbits(worst / 2.0)} on"
    )


def slow(missed: Missed, evidence: FlightEvidence) -> str:
    """It settled, with an error that fell all the way."""
    if missed.settled is None or missed.limit is None:
        return ""
    way = evidence.course[: int(2.0 * missed.settled) + 1]
    if len(way) < 2 or min(way) <= 0.0:
        return ""
    factor = float(np.exp(2.0 * np.polyfit(np.arange(len(way)), np.log(way), 1)[0]))
    if factor > FALLS:
        return ""
    return (
        f"slow: from {number(way[0])} {_unit(missed)} RMS in the first half orbit the error fell to "
        f"{part(factor)} of itself an orbit, and so to {number(missed.limit)} at {orbits(missed.settled)}"
    )


def recent(missed: Missed, evidence: FlightEvidence) -> str:
    """The error has fallen below the limit, and has not been there for an orbit."""
    trend = evidence.trend
    if missed.settled is not None or missed.limit is None or not _falls(trend) or trend[-1] > missed.limit:
        return ""
    return (
        f"too early to say: {number(trend[-1])} {_unit(missed)} RMS in the last half orbit, and not within "
        f"{number(missed.limit)} for an orbit yet"
    )


def swings(missed: Missed, evidence: FlightEvidence) -> str:
    """It does not settle, and the error no longer falls."""
    trend = evidence.trend
    if missed.settled is not None or missed.limit is None or len(trend) < TREND or min(trend) <= 0.0:
        return ""
    if _falls(trend):
        return ""
    span = f"{number(min(trend))} to {number(max(trend))} {_unit(missed)} RMS"
    return (
        f"the error falls no longer: {span} in each of the last {len(trend)} half orbits, "
        f"and more than {number(missed.limit)} at times"
    )


def _falls(trend: Sequence[float]) -> bool:
    """Whether it falls by more than chance."""
    if len(trend) < TREND or min(trend) <= 0.0:
        return False
    return float(np.polyfit(np.arange(len(trend)) / 2.0, np.log(trend), 1)[0]) <= log(FALLS)


def _unit(missed: Missed) -> str:
    return "deg/s" if missed.what in ("spin", "rate") else "deg"


# --- The causes

TREND = 3
"""Half orbits from which a trend is determined."""
COARSE = 4.0
"""Times the limit that a pulse may turn the body: the law fires where that reduces a libration, so that the
error is about a fifth of the turn."""
CONTRADICTED = 1.5
"""Times the error of the flight that the least one by linear theory may be."""
OVER_DEG = 20.0
"""Error from which a body that gravity does not hold has fallen over."""
HOPELESS = 0.25
"""Part of what gravity takes below which the highest level is too weak, however short the flight."""
HONEST = 0.9
"""Part of the time inside its own 3 sigma from which an estimate is honest."""
MOSTLY = 0.5
"""Part of the last orbit for which the attitude is valid, if the estimate is good for anything."""
AS_LARGE = 0.4
"""Part of a limit from which an error of the estimate is a cause."""
HALVES_IN_SHADOW = 4
"""Half orbits at the end in which the estimate in the shadow counts: what it has misled takes an orbit."""
UNSURE = 0.02
"""Part of the shadow from which an estimate that the control cannot use counts."""
LATE = 0.4
"""Fraction of a flight after which it is late for what must come first: attitude, low rate."""


Find = Callable[[Missed, FlightEvidence], str]
"""The sentence of a cause; empty if it is not the cause."""


class Diagnosis(NamedTuple):
    """A cause: its name, the indices that it explains, what finds it, and the causes that lead to it."""

    name: str
    indices: frozenset[str]
    find: Find
    unless: frozenset[str] = frozenset()


class Reason(NamedTuple):
    """A cause that was found, in words."""

    cause: str
    text: str


def reasons(missed: Missed, evidence: FlightEvidence) -> list[Reason]:
    """All causes that are found, in the order of the table; one that says so if there is none."""
    found: list[Reason] = []
    for cause in _applicable(missed, evidence):
        if cause.unless & {reason.cause for reason in found}:
            continue
        if text := cause.find(missed, evidence):
            found.append(Reason(cause.name, text))
    return found or [_unknown(missed, evidence)]


def _applicable(missed: Missed, evidence: FlightEvidence) -> list[Diagnosis]:
    """The causes that may make a flight miss this; of another flight software none that lies in this one."""
    others = frozenset() if evidence.own_software else OF_OWN_SOFTWARE
    return [cause for cause in CAUSES if missed.name in cause.indices and cause.name not in others]


def _unknown(missed: Missed, evidence: FlightEvidence) -> Reason:
    ruled_out = [cause.name.replace("_", " ") for cause in _applicable(missed, evidence)]
    return Reason("unknown", f"none of the causes that a flight can show; ruled out: {', '.join(ruled_out)}")


def _isolated(missed: Missed, evidence: FlightEvidence) -> str:
    since = [f"{unit} since {orbits(at)}" for unit, at in evidence.isolated.items()]
    return f"isolated: {', '.join(since)}" if since else ""


def _safe(missed: Missed, evidence: FlightEvidence) -> str:
    in_safe = evidence.in_mode.get(Mode.SAFE, 0.0)
    return f"the controller was in SAFE for {part(in_safe)} of the flight" if in_safe > LATE else ""


def _dark(missed: Missed, evidence: FlightEvidence) -> str:
    if evidence.scenario.knowledge != "filter" or evidence.lit_from == 0.0:
        return ""
    lit, valid = evidence.lit_from or inf, evidence.first_valid or inf
    if evidence.first_valid == 0.0 or valid < lit or valid < LATE * evidence.orbits:
        return ""
    seen = f"until {orbits(lit)}" if lit < inf else "and does not leave it"
    known = f"known from {orbits(valid)} on" if valid < inf else "never known"
    return f"the flight begins in eclipse {seen}: the attitude is {known}"


def _tumbling(missed: Missed, evidence: FlightEvidence) -> str:
    modes = flight_table(evidence.scenario).modes
    slow = inf if evidence.slow_from is None else evidence.slow_from
    if evidence.rate_degps <= modes.fast_degps or slow <= LATE * evidence.orbits:
        return ""
    last = f"still {number(evidence.rate_last_degps)} deg/s" if slow == inf else f"slow since {orbits(slow)}"
    acquires = f"; ACQUIRE begins under {modes.slow_degps:g} deg/s" if evidence.own_software else ""
    return f"tumbling: {number(evidence.rate_degps)} deg/s at the start, {last}{acquires}"


def _shadow(missed: Missed, evidence: FlightEvidence) -> str:
    if evidence.unsure_dark < UNSURE or not _is_honest(evidence) or beyond_bounds(evidence.scenario):
        return ""  # less certain by what the bounds say, not by what contradicts them
    return (
        f"for {part(evidence.unsure_dark)} of its time in the Earth's shadow the estimate was less certain "
        "than the control can use, by the bounds of [flight.uncertainty]: it then damps rates alone"
    )


def _shadow_estimate(missed: Missed, evidence: FlightEvidence) -> str:
    worst_deg = max(evidence.dark_course[-HALVES_IN_SHADOW:], default=0.0)
    if missed.limit is None or missed.what == "spin" or worst_deg < AS_LARGE * missed.limit:
        return ""
    return (
        "in the Earth's shadow, with the magnetometer alone, the estimate was wrong by "
        f"{number(worst_deg)} deg RMS, and the control follows it"
    )


def _estimate(missed: Missed, evidence: FlightEvidence) -> str:
    gives_none = not evidence.own_software and evidence.first_valid is None
    if evidence.scenario.knowledge != "filter" or gives_none:
        return ""
    if evidence.first_valid is None:
        return "the estimate never converged: no attitude was called valid"
    if evidence.valid_part < MOSTLY or evidence.estimate_deg is None:
        return f"the attitude was called valid for {part(evidence.valid_part)} of the last orbit only"
    share = 1.0 if missed.name == "ake" else AS_LARGE
    if missed.limit is None or missed.what == "spin" or evidence.estimate_deg < share * missed.limit:
        return ""
    wrong = f"the estimate is wrong by {number(evidence.estimate_deg)} deg RMS"
    if evidence.within_3sigma is not None and not _is_honest(evidence):
        return f"{wrong}, and dishonest: inside its own 3 sigma {part(evidence.within_3sigma)} of the time"
    return f"{wrong}, as it states itself"


def _is_honest(evidence: FlightEvidence) -> bool:
    """Whether its errors are those that the estimate states; it may have been valid too rarely to tell."""
    return evidence.within_3sigma is None or evidence.within_3sigma >= HONEST


def _mismatch(missed: Missed, evidence: FlightEvidence) -> str:
    lost = evidence.first_valid is not None and evidence.valid_part < MOSTLY
    misled = lost or not _is_honest(evidence)
    found = beyond_bounds(evidence.scenario, misled)
    return f"the satellite is not within the bounds of its onboard table: {'; '.join(found)}" if found else ""


def _any_law(missed: Missed, evidence: FlightEvidence) -> str:
    if missed.limit is None or missed.what != "attitude" or not any(evidence.torque_nm):
        return ""
    least = least_error_deg(evidence.scenario, evidence.orbits, evidence.torque_nm)
    last = evidence.trend[-2:]
    flown = float(np.sqrt(np.mean(np.square(last)))) if last else inf
    if least is None or least > CONTRADICTED * flown or min(least, flown) < 0.8 * missed.limit:
        return ""
    torque = number(float(np.linalg.norm(evidence.torque_nm)))
    return (
        f"a torque of {torque} N m on the mean leaves some {number(min(least, flown))} deg whatever the law: "
        "coils give none along the field"
    )


def _disturbance(missed: Missed, evidence: FlightEvidence) -> str:
    found = balance(evidence.scenario, evidence.torque_nm, missed.what)
    if found.load < TOO_WEAK:
        return ""
    by = "residual dipole" if found.of_dipole else "disturbance torque"
    return (
        f"balancing the {by} takes {part(found.load)} of what the coils can give: too weak to point with; "
        f"a highest level of {found.level_am2:g} A m^2 would do"
    )


def _unstable(missed: Missed, evidence: FlightEvidence) -> str:
    control, body = evidence.scenario.control, body_of(evidence.scenario)
    if control.law != "pd" or evidence.scenario.telecommand:
        return ""
    gains, pulsing = Gains(control.k_w, control.k_a, control.k_i or None), pulsing_of(evidence.scenario)
    if pulsing is None:
        degree = float(degree_of_stability(monodromy(closed_loop(body, gains))))
    else:
        degree = float(PulsedLoop(body, pulsing, 6 if gains.k_i is None else 9).degree(gains))
    if degree < NEUTRAL:
        return ""
    growth = number(exp(min(2.0 * np.pi * degree, 700.0)))
    return f"the gains are unstable by Floquet theory: a deviation grows {growth} times an orbit"


def _gravity(missed: Missed, evidence: FlightEvidence) -> str:
    trend = evidence.trend
    if len(trend) < TREND or missed.what not in ("attitude", "axis") or trend[-1] < OVER_DEG:
        return ""
    gravity, weak = gravity_on(evidence.scenario), _is_weaker_than_gravity(evidence)
    turned = gravity.rests_elsewhere and not weak  # what weak coils cannot hold need not be much
    return f"gravity {gravity_words(gravity)}" if gravity.falls_over or turned else ""


def _coarse(missed: Missed, evidence: FlightEvidence) -> str:
    lowest, total = evidence.levels[0], sum(evidence.levels)
    if (
        evidence.scenario.coils.driver == "continuous"
        or missed.limit is None
        or missed.what == "spin"
        or 2 * lowest < total
        or not total
    ):
        return ""
    turn, level = pulse_turn_deg(evidence.scenario, missed.what), evidence.scenario.coils.levels_am2[0]
    if turn < COARSE * missed.limit:
        return ""
    return (
        f"the levels are too coarse: a pulse at level 1, {number(level)} A m^2, makes a libration of up to "
        f"{number(turn)} deg; {number(0.5 * COARSE * level * missed.limit / turn)} A m^2 would do"
    )


def _weak(missed: Missed, evidence: FlightEvidence) -> str:
    largest_am2, gradient_am2 = evidence.scenario.coils.largest_am2, gradient_level_am2(evidence.scenario)
    if not evidence.own_software and not _is_weaker_than_gravity(evidence):
        return ""  # its gains may be too high, or it drives at the highest level alone
    most, of = _at_most(missed, evidence)
    if len(evidence.trend) < TREND and largest_am2 > HOPELESS * gradient_am2:
        return ""  # strong coils, too, are at their highest level while they turn the body
    if not of:
        return ""
    least = max(gradient_am2, 2.0 * largest_am2)
    return (
        f"the coils are too weak: at the highest level in {part(most)} of {of}; "
        f"it takes one of at least {number(least)} A m^2"
    )


def _is_weaker_than_gravity(evidence: FlightEvidence) -> bool:
    """Whether the highest level is less than the largest gravity gradient takes."""
    return evidence.scenario.coils.largest_am2 < gradient_level_am2(evidence.scenario)


def _saturates(missed: Missed, evidence: FlightEvidence) -> str:
    largest_am2, gradient_am2 = evidence.scenario.coils.largest_am2, gradient_level_am2(evidence.scenario)
    most, of = _at_most(missed, evidence)
    if evidence.own_software or not of or _is_weaker_than_gravity(evidence) or len(evidence.trend) < TREND:
        return ""
    return (
        f"the highest level is asked for in {part(most)} of {of}, and the coils are not too weak: "
        f"{number(largest_am2)} A m^2, of which gravity takes {number(gradient_am2)}: are the gains too "
        "high, or is it never near enough to ask for less?"
    )


def _at_most(missed: Missed, evidence: FlightEvidence) -> tuple[float, str]:
    """The part of the pulses, or of the time, at the highest level, and of which; no words: not for most."""
    highest, total, of = evidence.levels[2], sum(evidence.levels), "the last orbit"
    if missed.settled is not None and _has_settled(missed) and evidence.pulses:
        before = [level for at, level in evidence.pulses if at < missed.settled]
        highest, total, of = before.count(3), len(before), f"{orbits(missed.settled)}"
    most = evidence.saturated_part if not total else highest / total
    if most < 0.6 or (total and total < 5):
        return most, ""
    return most, f"the pulses of {of}" if total else of


def _never_in_point(missed: Missed, evidence: FlightEvidence) -> str:
    if evidence.first_in_point is not None:
        return ""
    modes = flight_table(evidence.scenario).modes
    longest = max(evidence.in_mode, key=lambda mode: evidence.in_mode[mode], default=Mode.SAFE)
    needs = {
        Mode.DETUMBLE: f" (it ends under {modes.slow_degps:g} deg/s for {modes.settle_s:g} s)",
        Mode.ACQUIRE: f" (it ends under {modes.near_deg:g} deg for {modes.hold_s:g} s)",
    }
    return (
        f"mode POINT was never reached: {longest.name}{needs.get(longest, '')} for "
        f"{part(evidence.in_mode.get(longest, 0.0))} of the flight"
    )


def _has_settled(missed: Missed) -> bool:
    """It has settled, but later than it should."""
    return missed.name == "settling" and missed.settled is not None


def _short(missed: Missed, evidence: FlightEvidence) -> str:
    near = sum(evidence.in_mode.get(mode, 0.0) for mode in (Mode.ACQUIRE, Mode.POINT))
    elsewhere = evidence.own_software and near < 0.5
    if len(evidence.trend) >= TREND or elsewhere or _has_settled(missed):
        return ""
    flown = orbits(evidence.orbits)
    return f"too early to say: a flight of {flown} is too short to settle, or to tell when it would"


def _not_settled(missed: Missed, evidence: FlightEvidence) -> str:
    trend = evidence.trend
    if _has_settled(missed):
        return ""
    if len(trend) < TREND or missed.limit is None or min(trend) <= 0.0 or trend[-1] <= missed.limit:
        return ""
    slope = float(np.polyfit(np.arange(len(trend)) / 2.0, np.log(trend), 1)[0])
    if slope > log(0.9):
        return ""
    when = evidence.orbits + log(missed.limit / trend[-1]) / slope
    return (
        f"not settled yet: the error falls to {part(exp(slope))} of itself an orbit, "
        f"and would be {number(missed.limit)} at about {orbits(when)}"
    )


POINTING = frozenset(("ape", "mpe", "rpe", "settling", "rate"))
SETTLING = frozenset(("settling",))
KNOWING = POINTING | {"ake"}
ALL = KNOWING | {"duty", "energy"}
BEFORE_KNOWING = frozenset(("isolated", "safe", "dark", "tumbling"))
BEFORE_POINTING = frozenset(("safe", "dark", "tumbling", "shadow", "estimate"))
CANNOT_POINT = frozenset(("isolated", "gravity", "unstable", "disturbance", "any_law"))
OF_ESTIMATE = frozenset(("shadow", "estimate", "shadow_estimate"))
POINT_IS_LOST = BEFORE_POINTING | CANNOT_POINT | {"coarse", "weak", "not_settled"}

OF_OWN_SOFTWARE = frozenset(
    (
        "isolated",
        "safe",
        "dark",
        "shadow",
        "shadow_estimate",
        "mismatch",
        "unstable",
        "never_in_point",
        "fell_back",
    )
)
"""What lies in modes, events, table or laws of this project's flight software."""

CAUSES: Sequence[Diagnosis] = (
    Diagnosis("isolated", ALL, _isolated),
    Diagnosis("safe", KNOWING, _safe, frozenset(("isolated",))),
    Diagnosis("dark", KNOWING, _dark),
    Diagnosis("tumbling", KNOWING, _tumbling),
    Diagnosis("coarse", POINTING, _coarse, BEFORE_KNOWING),  # such pulses disturb the estimate, too
    Diagnosis("shadow", KNOWING, _shadow, BEFORE_KNOWING | {"coarse"}),
    Diagnosis("estimate", KNOWING, _estimate, BEFORE_KNOWING | {"coarse", "shadow"}),
    Diagnosis("mismatch", ALL, _mismatch),
    Diagnosis("gravity", POINTING, _gravity, BEFORE_POINTING | {"isolated"}),
    Diagnosis("any_law", POINTING, _any_law, frozenset(("gravity",))),
    Diagnosis("disturbance", ALL - {"ake"}, _disturbance, frozenset(("gravity",))),
    Diagnosis("unstable", ALL - {"ake"}, _unstable, frozenset(("gravity",))),
    Diagnosis("weak", POINTING, _weak, BEFORE_POINTING | CANNOT_POINT),
    Diagnosis("saturates", POINTING, _saturates, BEFORE_POINTING | CANNOT_POINT | {"coarse"}),
    Diagnosis("not_settled", POINTING, _not_settled, CANNOT_POINT | {"safe", "shadow", "estimate", "coarse"}),
    Diagnosis("short", POINTING, _short, POINT_IS_LOST),
    Diagnosis("never_in_point", POINTING, _never_in_point, POINT_IS_LOST | {"short"}),
    Diagnosis("shadow_estimate", POINTING, _shadow_estimate, POINT_IS_LOST | {"mismatch", "short"}),
    Diagnosis("fell_back", SETTLING, fell_back, CANNOT_POINT | {"safe", "tumbling"} | OF_ESTIMATE),
    Diagnosis("left_again", SETTLING, left_again, POINT_IS_LOST | OF_ESTIMATE | {"fell_back"}),
    Diagnosis("slow", SETTLING, slow, POINT_IS_LOST | OF_ESTIMATE | {"fell_back", "left_again"}),
    Diagnosis("recent", SETTLING, recent, POINT_IS_LOST | OF_ESTIMATE | {"fell_back", "left_again", "slow"}),
    Diagnosis(
        "swings",
        SETTLING,
        swings,
        POINT_IS_LOST | OF_ESTIMATE | {"fell_back", "left_again", "short", "never_in_point"},
    ),
)
"""In the order in which one may lead to the next."""
