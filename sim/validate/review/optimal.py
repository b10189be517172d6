"""Claims: three axes, optimal control of a linear model (section 3.2)."""

from collections.abc import Sequence
from functools import partial
from math import radians
from typing import Any

import numpy as np

from fsw.core.laws.feedback.projection import torque_dipole
from fsw.core.laws.optimal.boxed import boxed_dipole
from fsw.core.laws.optimal.h_infinity import HInfinityGains, robust_schedule
from fsw.core.laws.optimal.lqr import LqrGains, orbit_problem, schedule
from fsw.core.laws.plan.riccati import periodic
from sim.campaign.claim import Claim, ClaimOutcome, Study, Threshold
from sim.design.robust.invariant import periodic_cost
from sim.design.robust.measured import Measured, central, least, norm
from sim.design.robust.norms import Norms, norms
from sim.design.robust.pd_gains import best_pd, pd_tabulated
from sim.design.theory.bodies import BODIES, Vec3
from sim.validate.review.flown import regulators

BODY, WHEEL_NMS = BODIES[2], (0.0, 0.0, 0.05)
REVIEW = "Ovchinnikov, Roldugin 2019, sections 2.2 and 3.2"
PD_START = (6.2694e6, 1614.9)
GAMMA = {False: 2.0, True: 0.4}
"""Near the least that can be had, without the wheel and with it."""
MOST_AM2, CASES = 0.5, 200
FIELD_T, TORQUE_NM = 2e-5, 2e-5
ERROR = 0.01
"""Of the field above the equator."""


def studies() -> list[Study]:
    """All of this section."""
    return [
        robust(False),
        robust(True),
        worst_torque_gains(),
        riccati(),
        boxed(),
        measured(),
        *regulators.studies(),
    ]


def robust(wheel: bool) -> Study:
    """The robust regulator beside the plain one, by their norms."""
    name = "wheel" if wheel else "three_axis"
    of = "with a wheel of 0.05 N m s" if wheel else "without a wheel"
    claims = (
        Claim(
            f"review.optimal.norms.{name}.h_infinity",
            f"H-infinity norm, robust over plain regulator, {of}: less",
            f"{REVIEW} [49, 50, 105]",
            "1",
            high=1.0,
            threshold=Threshold.PAPER,
        ),
        Claim(
            f"review.optimal.norms.{name}.h2",
            f"H2 norm, plain over robust regulator, {of}: less",
            f"{REVIEW} [48, 104]",
            "1",
            high=1.0,
            threshold=Threshold.PAPER,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        plain, bold = found[0]
        return [
            claims[0].judge(bold.h_infinity / plain.h_infinity, f"{bold.h_infinity:.3g} rad"),
            claims[1].judge(plain.h2 / bold.h2, f"{plain.h2:.3g} rad"),
        ]

    return Study(f"review.optimal.norms.{name}", (partial(both_norms, wheel),), conclude)


def both_norms(wheel: bool) -> tuple[Norms, Norms]:
    """Of the plain and of the robust regulator."""
    orbit = _orbit(WHEEL_NMS if wheel else (0.0, 0.0, 0.0))
    problem, field = orbit_problem(*orbit, LqrGains())
    plain = schedule(*orbit, LqrGains())
    bold = robust_schedule(*orbit, HInfinityGains(gamma=GAMMA[wheel]))
    first, second = (norms(problem, field, each.gains[:, :, :6], _unit_nm()) for each in (plain, bold))
    return first, second


def worst_torque_gains() -> Study:
    """PD gains by the H-infinity norm."""
    claim = Claim(
        "review.optimal.pd_h_infinity",
        "H-infinity norm of the PD law, its own gains over those of best stability: less",
        f"{REVIEW} [105]",
        "1",
        high=1.0,
        threshold=Threshold.PAPER,
    )
    return Study(claim.id, (pd_ratio,), lambda found: [claim.judge(*found[0])])


def pd_ratio() -> tuple[float, str]:
    """The ratio of the norms, and the gains found."""
    problem, field = orbit_problem(*_orbit((0.0, 0.0, 0.0)), LqrGains())
    found = best_pd(problem, field, _unit_nm(), PD_START)
    before = norms(problem, field, pd_tabulated(field, *PD_START), _unit_nm())
    return found.norms.h_infinity / before.h_infinity, f"k_w {found.k_w:.4g}, k_a {found.k_a:.4g}"


def riccati() -> Study:
    """Two ways to the periodic Riccati equation."""
    claim = Claim(
        "review.optimal.riccati",
        "Periodic Riccati equation by invariant subspace against doubling, relative",
        f"{REVIEW} [100]",
        "1",
        high=1e-6,
        wide="both are exact but for rounding",
    )
    return Study(claim.id, (riccati_difference,), lambda found: [claim.judge(found[0])])


def riccati_difference() -> float:
    """The largest difference of P against the roots of its diagonal."""
    case = orbit_problem(*_orbit((0.0, 0.0, 0.0)), LqrGains(effort=1.0))
    expected = periodic(*case)[1][0, :, :6]
    scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    return float((np.abs(periodic_cost(*case) - expected) / scale).max())


def boxed() -> Study:
    """Least squares within the limits beside the projection cut to them."""
    claim = Claim(
        "review.optimal.boxed",
        f"Miss of the torque where a limit is met, least squares over projection, mean of {CASES}: less",
        f"{REVIEW} [97]",
        "1",
        high=1.0,
        threshold=Threshold.PAPER,
    )
    return Study(claim.id, (mean_miss,), lambda found: [claim.judge(found[0])])


def mean_miss() -> float:
    """The ratio of the mean misses."""
    random, misses = np.random.default_rng(11), []
    for _ in range(CASES):
        b, torque = FIELD_T * random.standard_normal(3), TORQUE_NM * random.standard_normal(3)
        given = (_vec3(torque), _vec3(b))
        free = np.array(torque_dipole(*given))
        if np.abs(free).max() > MOST_AM2:
            dipoles = (boxed_dipole(*given, MOST_AM2), np.clip(free, -MOST_AM2, MOST_AM2))
            misses.append([float(np.linalg.norm(np.cross(m, b) - torque)) for m in dipoles])
    ours, cut = np.mean(misses, axis=0)
    return float(ours / cut)


def measured() -> Study:
    """The robust law that sees the field alone beside LQG, which sees it too."""
    claims = (
        Claim(
            "review.optimal.measured.h_infinity",
            "H-infinity norm from torque and field's error, robust law of the measured field over LQG: less",
            f"{REVIEW} [106]",
            "1",
            high=1.0,
            threshold=Threshold.PAPER,
        ),
        Claim(
            "review.optimal.measured.bound",
            "That norm over the bound for which the law was made, by another computation",
            f"{REVIEW} [106]",
            "1",
            low=0.9,
            high=1.0,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        gamma, robust, plain = found[0]
        return [claims[0].judge(robust / plain, f"{robust:.3g} rad"), claims[1].judge(robust / gamma)]

    return Study("review.optimal.measured", (measured_norms,), conclude)


def measured_norms() -> tuple[float, float, float]:
    """The bound, and the norms of the law made for it and of LQG."""
    problem, field = orbit_problem(*_orbit((0.0, 0.0, 0.0)), LqrGains())
    case = Measured(problem, field, _unit_nm(), ERROR * BODY.field_t)
    plain = norm(case, central(case, np.inf))
    gamma, found = least(case, 0.3 * plain, 1.1 * plain)
    return gamma, norm(case, found), plain


def _orbit(wheel_nms: Vec3) -> tuple[Any, Vec3, float, float, float]:
    return (BODY.inertia_kgm2, wheel_nms, BODY.rate_radps, radians(BODY.inclination_deg), BODY.field_t)


def _unit_nm() -> float:
    return BODY.rate_radps**2 * float(np.trace(np.array(BODY.inertia_kgm2))) / 3.0


def _vec3(v: Any) -> Vec3:  # noqa: ANN401
    x, y, z = np.asarray(v).tolist()
    return (x, y, z)
