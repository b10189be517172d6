"""Claims that linear theory decides: margins of the inertia, pulses, controllability."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf

from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.theory.bodies import BODIES
from sim.design.theory.floquet import ROUGH_STEPS
from sim.design.theory.linear import Gains, conditioning
from sim.design.theory.pulsed import PulsedLoop, Pulsing
from sim.design.theory.robustness import margins
from sim.design.theory.search import continuous
from sim.validate.review.fifty_kg import BODY, PD

REVIEW = "Ovchinnikov, Roldugin 2019"
BOOM = next(body for body in BODIES if body.name == "boom")
BOOM_BEST = Gains(3.2433e8, 4.7969e4)
"""Its best gains by Floquet theory."""


def studies() -> list[Study]:
    """All of this module."""
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
