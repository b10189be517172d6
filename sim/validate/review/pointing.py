"""Claims on laws that hold the whole attitude, by coils alone or beside a wheel of constant speed."""

from collections.abc import Sequence
from math import cos, degrees, pi, radians, sin

import numpy as np

from fsw.core.laws.lqr import LqrGains
from fsw.input.schema import Nested
from sim.campaign.claim import Study
from sim.tuning.flown import RigidFlight
from sim.validate.review.fifty_kg import BODY, PD
from sim.validate.review.rigid_trial import NEAR, RigidTrial, Trial, TrialFigure, final_rms_deg, gains, over
from sim.value_types import Array

Flights = Sequence[RigidFlight]

TORQUE: Nested = {"disturbance": {"torque_nm": [1e-7, 1e-7, 1e-7]}}
SLENDER: Nested = {"body": {"inertia_kgm2": [0.2, 1.9, 1.95]}, "coils": {"max_dipole_am2": 5.0}}


def feedback_trials() -> list[Trial]:
    """Section 3.1, feedback."""
    k_w, k_a = PD["k_w"], PD["k_a"]
    even, heavy = ({"q1": q1, "q2": 1.0, "q3": 1.0} for q1 in (1.0, 10.0))
    return [
        Trial(
            "review.feedback.pd",
            "section 3.1 [68-70]",
            (
                RigidTrial("pd", NEAR, 6.0),
                RigidTrial("pd", over(NEAR, gains("pd", k_w, k_a=300.0 * k_a)), 6.0),
            ),
            (
                _final("final", "PD law with the best gains", 5e-4),
                TrialFigure(
                    "bound",
                    "The same with 300 times the gain of the attitude: it is lost",
                    "deg RMS",
                    lambda flights: final_rms_deg(flights[1]),
                    low=20.0,
                ),
            ),
        ),
        Trial(
            "review.feedback.output",
            "section 3.1 [68]",
            (RigidTrial("output_feedback", NEAR, 6.0),),
            (_final("final", "Output feedback, without a rate", 0.2),),
        ),
        Trial(
            "review.feedback.regularised",
            "section 3.1 [82, 83]",
            (RigidTrial("pd_regularised", NEAR, 6.0),),
            (_final("final", "PD law by the regularised inverse", 1.5e-4),),
        ),
        Trial(
            "review.feedback.weighted",
            "section 3.1 [81]",
            tuple(
                RigidTrial("pd_weighted", over(NEAR, TORQUE, SLENDER, gains("pd_weighted", k_w, q, k_a)), 8.0)
                for q in (even, heavy)
            ),
            (
                TrialFigure(
                    "gain",
                    "RMS about the axis of small moment with a weight of 10 on it, over that with equal ones",
                    "1",
                    lambda flights: float(_axes_deg(flights[1])[0] / _axes_deg(flights[0])[0]),
                    high=0.4,
                ),
                TrialFigure(
                    "cost",
                    "The same about the other axes, the lesser",
                    "1",
                    lambda flights: float((_axes_deg(flights[1]) / _axes_deg(flights[0]))[1:].min()),
                    low=1.0,
                ),
            ),
        ),
    ]


def other_trials() -> list[Trial]:
    """Sliding control and the regulator."""
    return [
        Trial(
            "review.sliding.plain",
            "section 3.1 [91]",
            (RigidTrial("sliding", NEAR, 6.0),),
            (_final("final", "Sliding law", 4e-5),),
        ),
        Trial(
            "review.sliding.integral",
            "section 3.1 [93, 94]",
            tuple(RigidTrial(law, over(NEAR, TORQUE), 10.0) for law in ("sliding", "sliding_integral")),
            (
                TrialFigure(
                    "rms",
                    "With integrals under 1e-7 N m about each axis, tenth orbit",
                    "deg RMS",
                    lambda flights: final_rms_deg(flights[1]),
                    high=2.5,
                ),
                TrialFigure(
                    "gain",
                    "Without integrals over with them",
                    "1",
                    lambda flights: final_rms_deg(flights[0]) / final_rms_deg(flights[1]),
                    low=4.0,
                ),
            ),
        ),
        Trial(
            "review.optimal.lqr",
            "section 3.2 [98]",
            (RigidTrial("lqr", NEAR, 6.0), RigidTrial("pd", NEAR, 6.0)),
            (
                _final("final", "Periodic regulator", 4e-5),
                TrialFigure(
                    "cost",
                    "What the regulator makes least, theta^2 and dipole^2, over that of the PD law",
                    "1",
                    lambda flights: _cost(flights[0]) / _cost(flights[1]),
                    high=0.9,
                ),
            ),
        ),
    ]


def studies() -> list[Study]:
    """All of this module."""
    return [trial.study() for trial in (*wheel_trials(), *feedback_trials(), *other_trials())]


def _final(name: str, what: str, high: float) -> TrialFigure:
    """What an error that decays without end is down to: under ``high``, it has decayed as fast as it did."""
    return TrialFigure(
        name,
        f"{what}: attitude error in the sixth orbit, from 20 deg",
        "deg RMS",
        lambda flights: final_rms_deg(flights[0]),
        high=high,
    )


def _axes_deg(flight: RigidFlight) -> Array:
    """RMS about each body axis over the last two orbits, (3,)."""
    last = 2.0 * flight.q_body_from_orbit[flight.orbit(-2).start :, 1:]
    axes: Array = np.degrees(np.sqrt(np.mean(last**2, axis=0)))
    return axes


def _cost(flight: RigidFlight) -> float:
    """The sum of |theta|^2 + effort |m|^2 over the steps, m in units of J_mean w0^2 / B0."""
    mean_kgm2 = float(np.trace(np.array(BODY.inertia_kgm2))) / 3.0
    unit_am2 = mean_kgm2 * (2.0 * pi / flight.orbit_s) ** 2 / BODY.field_t
    dipoles = np.sum((flight.m_body_am2 / unit_am2) ** 2)
    return float(np.sum(np.radians(flight.pointing_deg) ** 2) + LqrGains().effort * dipoles)


# --- The laws of a satellite with a wheel of constant speed (section 2.2)

NORMAL = (0.0, -sin(radians(98.6)), cos(radians(98.6)))
"""Of the orbit, eci."""
PITCH_RAD = 0.5
WHEEL: Nested = {"body": {"inertia_kgm2": [1.9, 1.95, 2.0], "wheel_nms": [0.0, 0.0, 0.05]}}


def wheel_trials() -> list[Trial]:
    """Dual spin, and field tracking with the wheel and without."""
    stiff = {"pitch_rad": PITCH_RAD, "stiffness": 2.0}
    return [
        Trial(
            "review.wheel.dual_spin",
            "section 2.2 [18, 40]",
            (RigidTrial("dual_spin", over(WHEEL, NEAR, gains("dual_spin", 1e7, stiff, 4000.0)), 4.0),),
            (
                TrialFigure(
                    "tilt",
                    "The momentum from the orbit normal after 4 orbits, from 11 deg",
                    "deg",
                    lambda flights: float(flights[0].momentum_to_deg(NORMAL)[-1]),
                    high=1.2,
                ),
                TrialFigure(
                    "pitch",
                    "The body from its pitch of 0.5 rad then",
                    "deg",
                    lambda flights: abs(_pitch_deg(flights[0]) - degrees(PITCH_RAD)),
                    high=1.0,
                ),
            ),
        ),
        Trial(
            "review.wheel.tracking",
            "section 2.2 [42]",
            (
                RigidTrial(
                    "field_tracking", over(WHEEL, NEAR, gains("field_tracking", 1e7, k_a=2000.0)), 4.0
                ),
                RigidTrial("field_tracking", over(NEAR, gains("field_tracking", 6.27e6, k_a=1614.0)), 4.0),
            ),
            (
                TrialFigure(
                    "wheel",
                    "Attitude error by field tracking with a wheel after 4 orbits, from 20 deg",
                    "deg",
                    lambda flights: float(flights[0].pointing_deg[-1]),
                    high=0.5,
                ),
                TrialFigure(
                    "bare",
                    "The same without a wheel, by gains that suit the PD law: it is driven away",
                    "deg",
                    lambda flights: float(flights[1].pointing_deg[flights[1].orbit(-1)].min()),
                    low=20.0,
                ),
            ),
        ),
    ]


def _pitch_deg(flight: RigidFlight) -> float:
    """Turn about axis 3, body from orbit."""
    q0, _, _, q3 = flight.q_body_from_orbit[-1]
    return degrees(2.0 * np.arctan2(q3, q0))
