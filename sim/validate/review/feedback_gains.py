"""Claims: gains of the simple feedback (section 3.1), found on the ground."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

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
from sim.design.pd_limits import bifurcation, longest_hold_s, weaker
from sim.design.theory.bodies import BODIES, Body
from sim.design.theory.linear import Gains
from sim.design.theory.periodic_lqr import lqr_gains
from sim.validate.microsat import pointing_figures
from sim.validate.review.fifty_kg import BODY, PD, flight, last_orbit_deg
from sim.validate.review.figures import judged

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
    return [scheme(), limit(), robust(), settling(), hold(), tango(), averaged()]


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
