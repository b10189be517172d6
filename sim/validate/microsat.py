"""Claims on the 50 kg satellite with the filter in the loop: pointing, acquisition, consistency."""

from datetime import UTC, datetime
from math import inf

import numpy as np

from fsw.input.schema import Nested, merge
from fsw.wire.messages import Mode
from sim.campaign.claim import Study, Threshold
from sim.campaign.flight import Figures, Order
from sim.campaign.study import Figure, Group, campaign, figure_of, summary_value
from sim.plant.environment.orbit import Sgp4Orbit
from sim.plant.environment.sun import illumination, sun_eci_m
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.figures.attitude_arrays import angle_rad, relative
from sim.report.figures.estimate_error import nees
from sim.scenario.schema import Scenario, load, orbit_period_s
from sim.statistics.settling import settled_tick
from sim.validate.population.claims import consistent
from sim.value_types import Array

SCENARIO = "microsat"
SOURCE = "50 kg satellite with PoSAT-1's actuation limits; laws of Ovchinnikov, Roldugin, Ivanov, Penkov 2015"
FILTER = "Lefferts, Markley, Shuster 1982; bounds: Bar-Shalom, Li, Kirubarajan 2001, section 5.4"

POINTING_RUNS, STARTS_WITHIN_DEG = 10, 60.0
LAST_ORBITS = 4.0
BIAS_TORQUES = (("zero", 0.0, 0.6), ("3e-8", 3e-8, 1.5), ("1e-7", 1e-7, 4.0))
"""Name, bias torque per axis [N m], limit of the RMS pointing error [deg]."""

ACQUIRED_RUNS, ACQUIRED_DEG, ACQUIRED_DEGPS, ACQUIRED_ORBITS = 20, 10.0, 1.0, 6.0
ACQUISITION_ORBITS = 8.0

NEES_RUNS = 100
RATE_DEGPS, BIAS_SIZES_NT, TORQUES_NM, DAILY_PART = 0.3, (20.0, 500.0), (1e-9, 2e-7), 0.3
"""What is drawn for the filter's runs, whatever the filter assumes: see ``consistency``."""
BIASED_RUNS, BIAS_NT = 4, 500.0

LIMITS_KEPT = summary_value("limits_ok", 0.0)


def studies() -> list[Study]:
    """Pointing under bias torques, acquisition from any attitude, the filter's consistency."""
    return [pointing(), acquisition(), consistency(), magnetometer_bias()]


def pointing() -> Study:
    """Ten seeds for each bias torque, from attitudes up to 60 deg off."""
    groups = [
        Group(name, tuple(pointing_order(seed, torque_nm) for seed in range(1, POINTING_RUNS + 1)))
        for name, torque_nm, _ in BIAS_TORQUES
    ]
    figures = [
        Figure(
            f"rms_{name}",
            f"RMS pointing error, last {LAST_ORBITS:.0f} orbits, bias torque {torque_nm:g} N m about "
            f"each axis, from up to {STARTS_WITHIN_DEG:g} deg off, all seeds",
            "deg",
            figure_of("rms_deg"),
            group=name,
            high=limit_deg,
        )
        for name, torque_nm, limit_deg in BIAS_TORQUES
    ]
    limits = [
        Figure(
            f"limits_{name}",
            "Actuator limits kept, by the independent audit",
            "1",
            LIMITS_KEPT,
            group=name,
            low=1.0,
            threshold=Threshold.PAPER,
        )
        for name, *_ in BIAS_TORQUES
    ]
    return campaign("microsat", SOURCE, groups, figures + limits)


def acquisition() -> Study:
    """Random attitudes at 1 deg/s, half of them from the Earth's shadow."""
    orders = tuple(_acquisition_order(run) for run in range(ACQUIRED_RUNS))
    figures = (
        Figure(
            "held",
            f"In POINT and under {ACQUIRED_DEG:g} deg from then on after, from {ACQUIRED_RUNS} random "
            f"attitudes at {ACQUIRED_DEGPS:g} deg/s, all",
            "orbits",
            figure_of("held_orbits"),
            high=ACQUIRED_ORBITS,
        ),
        Figure(
            "final",
            "Largest pointing error at the end, none inverted",
            "deg",
            summary_value("pointing_deg.final"),
            high=5.0,
        ),
        Figure(
            "limits",
            "Actuator limits kept, by the independent audit",
            "1",
            LIMITS_KEPT,
            low=1.0,
            threshold=Threshold.PAPER,
        ),
    )
    return campaign("acquisition", SOURCE, (Group("", orders),), figures)


def consistency() -> Study:
    """NEES at the end of runs whose truth is drawn from a distribution of its own, not from the filter's.

    Attitude: any. Rate, bias and torque: any direction; the rate's size uniform up to ``RATE_DEGPS``, the
    logarithm of the bias's and torque's sizes uniform within ``BIAS_SIZES_NT`` and ``TORQUES_NM``. The torque
    varies in a day by up to ``DAILY_PART`` of itself, which the table declares, and holds no white noise, of
    which the filter assumes some. So the mean NEES need not be that of chi-square, 6 for six states: what is
    less uncertain than assumed lowers it. Above the bounds of chi-square for so many runs the filter claims
    more than it knows, below it is timid.
    """
    statement = f"Mean NEES of attitude and rate after one orbit, {NEES_RUNS} runs, truth not of its priors"
    figures = (consistent(statement, NEES_RUNS, figure_of("nees")),)
    orders = tuple(_random_order(run) for run in range(NEES_RUNS))
    return campaign("filter", FILTER, (Group("", orders),), figures)


def magnetometer_bias() -> Study:
    """A magnetometer bias that the filter has to estimate."""
    bias = {"sensors": {"magnetometer": {"bias_nt": [BIAS_NT, -BIAS_NT, BIAS_NT]}}}
    orders = tuple(Order(SCENARIO, bias, seed=seed) for seed in range(1, BIASED_RUNS + 1))
    figure = Figure(
        "sunlit",
        f"RMS attitude error of the filter, sunlit, magnetometer bias {BIAS_NT:g} nT per axis, all seeds",
        "deg",
        summary_value("estimate_deg.rms_sunlit"),
        high=0.2,
    )
    return campaign("filter_bias", FILTER, (Group("", orders),), (figure,))


def pointing_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """RMS pointing error of the last orbits."""
    error_deg = pointing_deg(truth)
    last = error_deg[-round(LAST_ORBITS * orbit_period_s(scenario) * scenario.time.tick_hz) :]
    return {"rms_deg": float(np.sqrt(np.mean(last**2)))}


def acquisition_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """Orbits after which it stays pointed, infinite if it does not."""
    held = (pointing_deg(truth) < ACQUIRED_DEG) & (estimates.mode[: len(truth["t_s"])] == Mode.POINT)
    first = settled_tick(held, scenario.time.tick_hz)
    return {
        "held_orbits": inf if first is None else first / scenario.time.tick_hz / orbit_period_s(scenario),
    }


def consistency_figures(scenario: Scenario, truth: Histories, estimates: Estimates) -> Figures:
    """NEES at the last tick."""
    return {"nees": float(nees(truth, estimates)[-1])}


def pointing_deg(truth: Histories) -> Array:
    """The angle between body and orbital frame at each tick."""
    q = truth["q_body_from_orbit"]
    upright = np.zeros_like(q)
    upright[:, 0] = 1.0
    return np.degrees(angle_rad(relative(upright, q)))


def pointing_order(seed: int, torque_nm: float, changed: Nested | None = None) -> Order:
    """A flight from an attitude up to 60 deg off, with ``changed`` laid over the scenario."""
    random = np.random.default_rng(seed)
    overrides: Nested = {
        "initial": {"axis": direction(random), "angle_deg": float(random.uniform(0.0, STARTS_WITHIN_DEG))},
        "disturbance": {"torque_nm": [torque_nm] * 3},
    }
    return Order(SCENARIO, merge(overrides, changed or {}), seed=seed, measure=pointing_figures)


def _acquisition_order(run: int) -> Order:
    random = np.random.default_rng(1000 + run)
    axis, angle_deg = _any_attitude(random)
    rate = [ACQUIRED_DEGPS * part for part in direction(random)]
    overrides: Nested = {
        "initial": {"axis": axis, "angle_deg": angle_deg, "rate_degps": rate},
        "time": {"epoch_utc": _epoch(random, dark=run % 2 == 1)},
    }
    return Order(SCENARIO, overrides, seed=run + 1, orbits=ACQUISITION_ORBITS, measure=acquisition_figures)


def _random_order(run: int) -> Order:
    """An order whose attitude, rate, bias and torque are drawn as ``consistency`` says."""
    random = np.random.default_rng(2000 + run)
    axis, angle_deg = _any_attitude(random)
    rate_degps, bias_nt, torque_nm = (
        [size * part for part in direction(random)]
        for size in (
            random.uniform(0.0, RATE_DEGPS),
            _log_uniform(random, BIAS_SIZES_NT),
            _log_uniform(random, TORQUES_NM),
        )
    )
    overrides: Nested = {
        "initial": {"axis": axis, "angle_deg": angle_deg, "rate_degps": rate_degps},
        "sensors": {"magnetometer": {"bias_nt": bias_nt}},
        "disturbance": {"torque_nm": torque_nm, "torque_daily_part": float(random.uniform(0.0, DAILY_PART))},
        "flight": {"uncertainty": {"torque_variation_nm": DAILY_PART * TORQUES_NM[1]}},
    }
    return Order(SCENARIO, overrides, seed=run + 1, orbits=1.0, measure=consistency_figures)


def _log_uniform(random: np.random.Generator, between: tuple[float, float]) -> float:
    return float(np.exp(random.uniform(*np.log(between))))


def direction(random: np.random.Generator) -> list[float]:
    """A unit vector, any."""
    vector = random.standard_normal(3)
    unit: list[float] = (vector / np.linalg.norm(vector)).tolist()
    return unit


def _any_attitude(random: np.random.Generator) -> tuple[list[float], float]:
    """Axis and angle [deg] of a uniformly random attitude."""
    q = random.standard_normal(4)
    sine, cosine = np.linalg.norm(q[1:]), abs(q[0])
    axis: list[float] = (q[1:] / sine).tolist()
    return axis, float(np.degrees(2.0 * np.arctan2(sine, cosine)))


def _epoch(random: np.random.Generator, dark: bool) -> str:
    """A time within a day of the elements' epoch at which the satellite is lit in full, or not at all."""
    scenario = load(SCENARIO)
    assert scenario.orbit.tle is not None
    epoch_unix_s = scenario.epoch_unix_s
    times = np.sort(random.integers(0, 86400, 50)).astype(float)
    r_m, _ = Sgp4Orbit(scenario.orbit.tle, epoch_unix_s).at(times)
    lit = illumination(r_m, sun_eci_m(epoch_unix_s, times))
    epoch_s = times[lit == (0.0 if dark else 1.0)][0]
    return _iso(epoch_unix_s + int(epoch_s))


def _iso(unix_s: int) -> str:
    return datetime.fromtimestamp(unix_s, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
