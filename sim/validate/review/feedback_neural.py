"""Claims: gains that trained units choose (section 3.4), on flights that the training has not seen."""

from functools import partial

import numpy as np

from fsw.core.laws.pd_neural import NeuralGains
from sim.campaign.claim import Claim, Study
from sim.design.neural_training import MOST_AM2, PD_GAINS, cost, orbit_rms_deg, trials
from sim.validate.review.fifty_kg import BODY
from sim.validate.review.figures import one_figure

SEEDS, FLIGHTS = (101, 102, 103), 24
"""Not those of the training."""
CONSTANT = (0.0,) * 6
"""Weights with which the factors of both gains are 1."""


def studies() -> list[Study]:
    """All of this module."""
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
