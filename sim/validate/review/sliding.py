"""Claims: three axes, sliding control (section 3.1)."""

from functools import partial

from fsw.core.laws.sliding_realisable import RealisableGains
from sim.campaign.claim import Claim, Study
from sim.validate.review.fifty_kg import SPHERE, flight, last_orbit_deg
from sim.validate.review.figures import judged
from sim.validate.review.law_flight import LawFlight, fly

SECTION = "Ovchinnikov, Roldugin 2019, section 3.1"
STEEP = {"reach": 3.0, "slope": 1.0}
"""A surface as steep as the orbit turns: more than the coils can follow with a constant matrix."""


def studies() -> list[Study]:
    """All of this section."""
    return [realisable(), rate(), twisting(), sphere()]


def realisable() -> Study:
    """The surface that coils can reach, beside the same one with a constant matrix."""
    source = f"{SECTION}, after Ovchinnikov et al. 2016 [95]"
    claims = (
        Claim(
            "review.sliding.realisable.converges",
            "Pointing error of sliding_realisable in the fifth orbit, from 100 deg, 50 kg, nothing unknown",
            source,
            "deg",
            high=1.0,
        ),
        Claim(
            "review.sliding.realisable.steep",
            "Largest pointing error over five orbits on a steep surface, from 20 deg, its matrix free",
            source,
            "deg",
            high=25.0,
        ),
        Claim(
            "review.sliding.realisable.constant",
            "The same with a constant matrix, which asks for torque along the field: it drives away",
            source,
            "deg",
            low=90.0,
        ),
    )
    constant = RealisableGains(**STEEP, least=0.999, most=1.001)
    tasks = (
        partial(last_orbit_deg, flight("sliding_realisable", 100.0)),
        partial(largest_deg, flight("sliding_realisable", 20.0, gains=RealisableGains(**STEEP))),
        partial(largest_deg, flight("sliding_realisable", 20.0, gains=constant)),
    )
    return Study("review.sliding.realisable", tasks, partial(judged, claims))


def rate() -> Study:
    """The surface without the inertia, with and without the torque that holds it."""
    source = f"{SECTION}, after Sofyali, Jafarov 2012 [92]"
    claims = tuple(
        Claim(
            f"review.sliding.rate.{name}",
            f"Pointing error of {law} in the second orbit, from 20 deg, 50 kg, nothing unknown",
            source,
            "deg",
            high=high,
        )
        for name, law, high in (
            ("classical", "sliding_rate", 15.0),
            ("modified", "sliding_rate_modified", 1.0),
        )
    )
    tasks = tuple(
        partial(last_orbit_deg, flight(law, 20.0, orbits=2.0))
        for law in ("sliding_rate", "sliding_rate_modified")
    )
    return Study("review.sliding.rate", tasks, partial(judged, claims))


def twisting() -> Study:
    """Super-twisting on the terminal surface, with coils that give torque in a plane only.

    The error stays near a degree by what is integrated: without it, it is half of that.
    """
    claim = Claim(
        "review.sliding.twisting",
        "Pointing error of sliding_twisting in the fifth orbit, from 20 deg, 50 kg, nothing unknown",
        f"{SECTION}, after Janardhanan, Nabi, Tiwari 2012 [96]",
        "deg",
        low=0.7,
        high=2.0,
    )
    tasks = (partial(last_orbit_deg, flight("sliding_twisting", 20.0)),)
    return Study(claim.id, tasks, partial(judged, (claim,)))


def sphere() -> Study:
    """The relay on the rate's surface."""
    claim = Claim(
        "review.sliding.sphere",
        "Pointing error of sliding_sphere in the fifth orbit, a sphere from 20 deg, nothing unknown",
        f"{SECTION}, after Wang, Shtessel 1998 [90]: asymptotically stable for a sphere",
        "deg",
        high=0.5,
    )
    tasks = (partial(last_orbit_deg, flight("sliding_sphere", 20.0, inertia_kgm2=SPHERE)),)
    return Study(claim.id, tasks, partial(judged, (claim,)))


def largest_deg(case: LawFlight) -> float:
    """The largest angle from the nominal attitude in the whole flight."""
    return float(fly(case).angle_deg.max())
