"""Claims: gains of the simple feedback, by theory and by training on the ground (sections 3.1, 3.4)."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from math import inf

import numpy as np

from fsw.core.laws.pd_neural import NeuralGains
from fsw.input.schema import Nested
from sim.campaign.claim import Claim, ClaimOutcome, Study, Threshold
from sim.campaign.flight import Order
from sim.campaign.study import Figure, Group, campaign, figure_of
from sim.design.averaged_error import search
from sim.design.inertial_gains import (
    best_of_all,
    best_on_line,
    minimax,
    robust_share,
    settling_orbits,
    spread_starts,
    worst_degree,
)
from sim.design.neural_training import MOST_AM2, PD_GAINS, cost, orbit_rms_deg, trials
from sim.design.pd_limits import bifurcation, longest_hold_s, weaker
from sim.design.theory.bodies import BODIES, Body
from sim.design.theory.floquet import ROUGH_STEPS
from sim.design.theory.linear import Gains, conditioning
from sim.design.theory.periodic_lqr import lqr_gains
from sim.design.theory.pulsed import PulsedLoop, Pulsing
from sim.design.theory.robustness import margins
from sim.design.theory.search import continuous
from sim.validate.microsat import pointing_figures
from sim.validate.review.fifty_kg import BODY, PD, flight, last_orbit_deg
from sim.validate.review.figures import judged, one_figure

SECTION = "Ovchinnikov, Roldugin 2019, section 3.1"
BEST = Gains(**PD)
BOUNDS = 0.5
"""Relative error of each moment of inertia."""
WEAK_AM2 = 0.2
"""Dipole of each coil for which minimax gains are sought."""
EFFORT = 0.1
"""Of the regulator from which TANGO's gains are drawn."""
TANGO_AM2 = 0.02
"""Residual dipole of each axis at which the 50 kg satellite points as TANGO did."""
TANGO_ORBITS = 7.0


def studies() -> list[Study]:
    """All of this module."""
    return [
        *(scheme(), limit(), robust(), settling(), hold(), tango(), averaged()),
        *linear_studies(),
        *neural_studies(),
    ]


def scheme() -> Study:
    """The scheme for inertial pointing."""
    claim = Claim(
        "review.feedback.scheme",
        "Best degree of stability on the line of averaging over that of all gains, least of six bodies",
        f"{SECTION}, after Ovchinnikov, Roldugin, Penkov 2015 [71]",
        "1",
        low=0.5,
    )
    return Study(claim.id, (least_share,), partial(judged, (claim,)))


def averaged() -> Study:
    """Feedback of an error averaged over three orbits, on the orbit and over the equator."""
    source = "Ovchinnikov, Roldugin 2019, section 3.2 [102, 103]"
    statement = "Best degree of stability with the error averaged over three orbits"
    claims = (
        Claim("review.feedback.averaged.orbits", f"{statement}, 50 kg", source, "1/rad", high=-0.1),
        Claim(
            "review.feedback.averaged.equator",
            f"{statement}, over the equator",
            source,
            "1/rad",
            low=-1e-3,
            wide="it is zero but for rounding",
        ),
        Claim(
            "review.feedback.averaged.cost",
            f"{statement}, over that with the error itself",
            source,
            "1",
            high=0.5,
        ),
    )

    def conclude(found: Sequence[float]) -> list[ClaimOutcome]:
        orbits, equator, itself = found
        return judged(claims, (orbits, equator, orbits / itself))

    searches = (
        partial(averaged_degree, BODY, 3.0),
        partial(averaged_degree, replace(BODY, inclination_deg=0.0), 3.0),
        partial(averaged_degree, BODY, 0.0),
    )
    return Study("review.feedback.averaged", searches, conclude)


def averaged_degree(body: Body, orbits: float) -> float:
    """The best degree of a law with an error averaged over so many orbits."""
    return search(body, orbits).degree


def tango() -> Study:
    """PD with gains by the regulator as flown: a residual dipole of which nothing is known."""
    figures = (
        Figure(
            "none",
            "RMS error of pd, gains by the regulator, orbits 4 to 7, attitude known, no residual dipole",
            "deg",
            figure_of("rms_deg"),
            group="none",
            high=1.0,
        ),
        Figure(
            "dipole",
            f"The same with a residual dipole of {TANGO_AM2:g} A m^2 an axis, unknown (TANGO: 10 to 20)",
            "deg",
            figure_of("rms_deg"),
            group="dipole",
            low=10.0,
            high=20.0,
            threshold=Threshold.FITTED,
        ),
    )
    groups = (Group("none", (tango_order(0.0),)), Group("dipole", (tango_order(TANGO_AM2),)))
    source = f"{SECTION}, after Chasset et al. 2013 [76, 77]"
    return campaign("review.feedback.tango", source, groups, figures)


def hold() -> Study:
    """Gains for long intervals."""
    claim = Claim(
        "review.feedback.hold",
        "Longest interval that is stable with gains 0.3 k_w, 0.09 k_a over that with the best gains",
        f"{SECTION}, after Celani 2016 [78]",
        "1",
        low=1.5,
    )
    return Study(claim.id, (longer_hold,), partial(judged, (claim,)))


def limit() -> Study:
    """The largest attitude gain."""
    source = f"{SECTION}, after Della Rossa, Bergamasco, Lovera 2012 [70]"
    claims = (
        Claim(
            "review.feedback.limit.factor",
            "Attitude gain at which the nominal attitude of the 50 kg satellite is lost, over the best one",
            source,
            "1",
            low=1.4,
            high=1.65,
        ),
        Claim(
            "review.feedback.limit.under",
            "Pointing error of pd in the last of eight orbits, from 5 deg, 10 % under that gain",
            source,
            "deg",
            high=1.0,
        ),
        Claim(
            "review.feedback.limit.over",
            "The same 20 % over it: the nominal attitude repels",
            source,
            "deg",
            low=10.0,
        ),
    )
    tasks = (limit_factor, partial(beside_limit_deg, 0.9), partial(beside_limit_deg, 1.2))
    return Study("review.feedback.limit", tasks, partial(judged, claims))


def robust() -> Study:
    """Gains for bounds on the inertia."""
    source = f"{SECTION}, after Celani 2015 [74]"
    claims = (
        Claim(
            "review.feedback.robust.broken",
            "Degree of stability of the best inertial gains with each moment off by half, at worst",
            source,
            "1/rad",
            low=0.05,
        ),
        Claim(
            "review.feedback.robust.share",
            "Largest e of gains e k_w, e^2 k_a that hold for all of them",
            source,
            "1",
            low=0.5,
            high=1.0,
        ),
    )
    return Study("review.feedback.robust", (broken_degree, share_that_holds), partial(judged, claims))


def settling() -> Study:
    """Minimax gains with weak coils."""
    claim = Claim(
        "review.feedback.minimax",
        f"Longest settling from 120 deg, coils of {WEAK_AM2:g} A m^2, minimax gains over those of the scheme",
        f"{SECTION}, after Bruni, Celani 2017 [75]",
        "1",
        high=0.95,
    )
    return Study(claim.id, (settling_ratio,), partial(judged, (claim,)))


def least_share() -> float:
    """Of all bodies, the best degree on the line over the best of all."""
    return float(np.min([best_on_line(body)[1] / best_of_all(body)[1] for body in BODIES]))


def limit_factor() -> float:
    """k_a at the bifurcation over the best one."""
    found = bifurcation(BODY, BEST)
    return np.inf if found is None else found.k_a / float(np.asarray(BEST.k_a))


def beside_limit_deg(factor: float) -> float:
    """The pointing error in the last of eight orbits at ``factor`` times the largest k_a."""
    gains = PD | {"k_a": PD["k_a"] * limit_factor() * factor}
    return last_orbit_deg(flight("pd", 5.0, orbits=8.0, **gains))


def broken_degree() -> float:
    """The worst degree of the best inertial gains within the bounds."""
    return worst_degree(BODY, best_of_all(BODY)[0], BOUNDS)


def share_that_holds() -> float:
    """The largest e within the bounds; 0 where there is none."""
    return robust_share(BODY, best_of_all(BODY)[0], BOUNDS) or 0.0


def settling_ratio() -> float:
    """The longest settling with minimax gains over that with the scheme's."""
    gains, _ = best_on_line(BODY)
    starts = spread_starts(8, 120.0, 2e-3)
    before = settling_orbits(BODY, gains, WEAK_AM2, starts, 2.0).max()
    return minimax(BODY, gains, WEAK_AM2, starts, 2.0)[1] / float(before)


def longer_hold() -> float:
    """The longest interval with weaker gains over that with the best."""
    return longest_hold_s(BODY, weaker(BEST, 0.3)) / longest_hold_s(BODY, BEST)


def tango_order(dipole_am2: float) -> Order:
    """A flight with continuous coils from 40 deg."""
    gains = lqr_gains(BODY, EFFORT)
    control: Nested = {
        "law": "pd",
        "k_w": float(np.asarray(gains.k_w)),
        "k_a": float(np.asarray(gains.k_a)),
        "k_i": 0.0,
    }
    overrides: Nested = {
        "knowledge": "perfect",
        "coils": {"driver": "continuous", "max_dipole_am2": 8.0},
        "disturbance": {
            "torque_nm": [0.0, 0.0, 0.0],
            "residual_dipole_am2": [dipole_am2, -dipole_am2, dipole_am2],
        },
        "control": control,
    }
    return Order("microsat", overrides, orbits=TANGO_ORBITS, measure=pointing_figures)


# --- What linear theory decides: margins of the inertia, pulses, controllability

REVIEW = "Ovchinnikov, Roldugin 2019"
BOOM = next(body for body in BODIES if body.name == "boom")
BOOM_BEST = Gains(3.2433e8, 4.7969e4)
"""Its best gains by Floquet theory."""


def linear_studies() -> list[Study]:
    """All of this section."""
    return [
        Study("review.feedback.inertia", (inertia_margin,), _judge_inertia),
        Study("review.feedback.pulses", (pulsed_degree,), _judge_pulses),
        Study("review.controllability", (controlled,), _judge_controlled),
    ]


def inertia_margin() -> float:
    """The least relative error of the moments that makes the best gains of a boom satellite unstable."""
    found = margins(BOOM, BOOM_BEST, continuous(BOOM, ROUGH_STEPS)).moments
    return inf if found is None else found


def pulsed_degree() -> float:
    """Degree of stability of the 50 kg satellite under pulses, 1/rad."""
    return float(PulsedLoop(BODY, Pulsing(3.0, 100.0, 300.0, True)).degree(Gains(**PD)))


def _judge_inertia(found: Sequence[float]) -> list[ClaimOutcome]:
    claim = Claim(
        "review.feedback.inertia.margin",
        "Least error of the moments at which the best gains of a satellite with a boom become unstable",
        f"{REVIEW}, section 3.1 [73]",
        "1",
        high=0.02,
    )
    return [claim.judge(found[0])]


def _judge_pulses(found: Sequence[float]) -> list[ClaimOutcome]:
    claim = Claim(
        "review.feedback.pulses.degree",
        "Degree of stability of 50 kg with its best gains, the dipole in pulses of 3 s each 103 s",
        f"{REVIEW}, section 3.1 [78, 79]",
        "1/rad",
        high=-0.2,
    )
    return [claim.judge(found[0])]


def controlled() -> tuple[float, float]:
    """Least over greatest eigenvalue of the Gramian of an orbit: of 50 kg, and the same at the equator."""
    return conditioning(BODY), conditioning(replace(BODY, inclination_deg=0.0))


def _judge_controlled(found: Sequence[tuple[float, float]]) -> list[ClaimOutcome]:
    source = f"{REVIEW}, introduction [4, 5, 9]"
    statement = "Least over greatest eigenvalue of the Gramian of an orbit, 50 kg, direct dipole"
    inclined = Claim("review.controllability.orbit", statement, source, "1", low=0.01)
    equator = Claim(
        "review.controllability.equator",
        f"{statement}, orbit over the equator",
        source,
        "1",
        high=1e-12,
        wide="it is zero but for rounding",
    )
    return [inclined.judge(found[0][0]), equator.judge(found[0][1])]


# --- Gains that trained units choose (section 3.4), on flights that the training has not seen

SEEDS, FLIGHTS = (101, 102, 103), 24
"""Not those of the training."""
CONSTANT = (0.0,) * 6
"""Weights with which the factors of both gains are 1."""


def neural_studies() -> list[Study]:
    """All of this section."""
    claim = Claim(
        "review.feedback.neural",
        "RMS angle of pd_neural over that of pd with its best constant gains, geometric mean of orbits, "
        f"{len(SEEDS) * FLIGHTS} flights with unknown torque and dipole, none of them trained on",
        "Ovchinnikov, Roldugin 2019, section 3.4, after Das, Sinha, Misra 2012 [113]",
        "1",
        high=0.98,
    )
    return [one_figure(claim, partial(ratio, NeuralGains()))]


def ratio(gains: NeuralGains) -> float:
    """Of the mean RMS angles, with these weights and with none."""
    trained = (gains.w0, gains.w1, gains.w2, gains.a0, gains.a1, gains.a2, gains.lag_orbits)
    members = np.array([trained, (*CONSTANT, gains.lag_orbits)])
    costs = [cost(orbit_rms_deg(BODY, PD_GAINS, members, trials(FLIGHTS, seed), MOST_AM2)) for seed in SEEDS]
    neural, constant = np.mean(costs, axis=0)
    return float(np.exp(neural - constant))
