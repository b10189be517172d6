"""Claims: damping of the rate (section 1 of the review)."""

from dataclasses import replace
from functools import partial

import numpy as np

from fsw.core.laws.bdot_held import HeldGains
from fsw.core.laws.damping import SwitchedGains
from fsw.core.laws.optimal_damping import EnergyGains, ModelGains, MomentumGains
from fsw.core.laws.rate_damping_matrix import MatrixGains
from sim.campaign.claim import Claim, Study, Threshold
from sim.plant.dynamics.jacobi import jacobi_integral
from sim.validate.review.figures import one_figure
from sim.validate.review.law_flight import LawFlight, LawHistory, fly

FULL = ((1.02, 0.03, -0.02), (0.03, 1.85, 0.05), (-0.02, 0.05, 1.95))
SPHERE = ((1.9, 0.0, 0.0), (0.0, 1.9, 0.0), (0.0, 0.0, 1.9))
TUMBLE = (0.02, -0.03, 0.025)
MATRIX = MatrixGains(1.5, 0.8, 1.2, 0.3, -0.2, 0.1)
LINEAR_K_W = 6e5
"""With which 1 A m^2 is nearly reached at the rate of the start, and never later."""
REVIEW = "Ovchinnikov, Roldugin 2019, section 1"


def studies() -> list[Study]:
    """All of this section."""
    return [
        one_figure(
            Claim(
                "review.damping.bdot_stop",
                "B-dot on a polar orbit ends at a mean rate of, over the last of four orbits",
                f"{REVIEW} [19]: just under twice the orbital rate",
                "w0",
                low=1.8,
                high=2.0,
            ),
            bdot_stop,
        ),
        one_figure(
            Claim(
                "review.damping.rate",
                "By the relative rate, under gravity gradient: what is left of it after four orbits",
                f"{REVIEW} [20-23]: the rate goes to zero exponentially",
                "w0",
                high=0.05,
                wide="exponential: it falls on",
            ),
            rate_left,
        ),
        one_figure(
            Claim(
                "review.damping.inclination",
                "A sphere's decay an orbit at 30 deg inclination, of that over the poles",
                f"{REVIEW} [24]: the speed depends on the inclination",
                "1",
                low=0.3,
                high=0.7,
            ),
            inclination_share,
        ),
        one_figure(
            Claim(
                "review.damping.jacobi",
                "Largest rise of the Jacobi integral in a step of 5 s, damping the relative rate",
                f"{REVIEW} [25]: the Jacobi integral is a Lyapunov function",
                "J",
                high=0.0,
                threshold=Threshold.PAPER,
            ),
            partial(jacobi_rise, "rate_damping"),
        ),
        one_figure(
            Claim(
                "review.damping.matrix",
                "Largest rise of the Jacobi integral in a step of 5 s, with a full matrix of gains",
                f"{REVIEW} [26]: a positive definite matrix instead of the scalar",
                "J",
                high=0.0,
                threshold=Threshold.PAPER,
            ),
            partial(jacobi_rise, "rate_damping_matrix", MATRIX),
        ),
        *_speeds(),
        one_figure(
            Claim(
                "review.damping.rate_model",
                "Time of the projected reference model (1/1000 s) to a tenth of the momentum, of the relay's",
                f"{REVIEW} [28]: the rate damped as three independent linear equations",
                "1",
                low=1.5,
                high=5.0,
            ),
            partial(time_share, "rate_model", ModelGains(), 0.1, "least_momentum"),
        ),
    ]


def _speeds() -> list[Study]:
    """Laws that are to be faster than a fixed gain, as shares of its time to 0.3 of the momentum."""
    rows: tuple[tuple[str, object, str, float, float], ...] = (
        ("bdot_switched", SwitchedGains(0.03, 5.0), "[27]: two values of the gain", 0.2, 0.95),
        ("bdot_held", HeldGains(50.0, 20.0), "a gain that keeps the torque", 0.2, 0.5),
        ("least_momentum", MomentumGains(5.0), "[28]: the optimal law is considerably faster", 0.15, 0.4),
        ("least_energy", EnergyGains(0.002), "[28]: the same for the energy", 0.15, 0.4),
    )
    return [
        one_figure(
            Claim(
                f"review.damping.{law}",
                f"Time of {law} to 0.3 of the momentum, of that of a fixed gain; coils of 1 A m^2",
                f"{REVIEW}, {claim}",
                "1",
                low=low,
                high=high,
            ),
            partial(time_share, law, gains, 0.3),
        )
        for law, gains, claim, low, high in rows
    ]


def bdot_stop() -> float:
    """Mean rate over the last of four orbits, in orbital rates."""
    flown = fly(
        LawFlight(
            "bdot", FULL, k_w=6.27e6, omega_body_radps=TUMBLE, orbits=4.0, gravity=False, inclination_deg=90.0
        )
    )
    rate = np.linalg.norm(flown.omega_body_radps, axis=1)[flown.orbits > 3.0]
    return float(rate.mean() / flown.orbit_rate_radps)


def rate_left() -> float:
    """Relative rate after four orbits, in orbital rates."""
    flown = fly(LawFlight("rate_damping", FULL, k_w=6.27e6, omega_body_radps=TUMBLE, orbits=4.0))
    return float(np.linalg.norm(flown.relative_body_radps[-1]) / flown.orbit_rate_radps)


def inclination_share() -> float:
    """Logarithm lost in the second of two orbits, at 30 deg over that at 90 deg."""
    lost = []
    for inclination_deg in (30.0, 90.0):
        flown = fly(
            LawFlight(
                "rate_damping",
                SPHERE,
                k_w=5e5,
                omega_body_radps=TUMBLE,
                orbits=2.0,
                gravity=False,
                inclination_deg=inclination_deg,
            )
        )
        rate = np.linalg.norm(flown.relative_body_radps, axis=1)
        lost.append(float(np.log(rate[len(rate) // 2] / rate[-1])))
    return lost[0] / lost[1]


def jacobi_rise(law: str, gains: object = None) -> float:
    """The largest rise of the Jacobi integral from step to step, J; zero if there is none."""
    flown = fly(
        LawFlight(
            law,
            FULL,
            k_w=6e6,
            gains=gains,
            omega_body_radps=(0.004, -0.003, 0.002),
            relative=True,
            orbits=1.5,
        )
    )
    integral = jacobi_integral(
        np.array(FULL), flown.q_body_from_orbit, flown.relative_body_radps, flown.orbit_rate_radps
    )
    return float(np.maximum(0.0, np.diff(integral).max()))


def time_share(law: str, gains: object, share: float, against: str = "bdot") -> float:
    """Time to a share of the momentum, of another law's."""
    case = LawFlight(
        law,
        FULL,
        k_w=LINEAR_K_W,
        gains=gains,
        omega_body_radps=TUMBLE,
        orbits=1.5,
        most_am2=1.0,
        gravity=False,
        step_s=4.0,
    )
    other = replace(case, law=against, gains=MomentumGains(5.0) if against == "least_momentum" else None)
    return time_to(fly(case), share) / time_to(fly(other), share)


def time_to(flown: LawHistory, share: float) -> float:
    """Orbits until the momentum is under a share of its first value; infinite if it never is."""
    momentum = np.linalg.norm(flown.momentum_eci_nms, axis=1)
    under = momentum < share * momentum[0]
    return float(flown.orbits[np.argmax(under)]) if under.any() else float("inf")
