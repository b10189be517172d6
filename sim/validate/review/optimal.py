"""Claims: three axes, optimal control of a linear model (section 3.2)."""

from collections.abc import Sequence
from functools import partial
from math import radians
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsw.core.laws.h_infinity import HInfinityGains, robust_schedule
from fsw.core.laws.lqr import LqrGains, orbit_problem, schedule
from fsw.core.laws.pd_boxed import boxed_dipole
from fsw.core.laws.plan.riccati import periodic
from fsw.core.laws.projection import torque_dipole
from sim.campaign.claim import Claim, ClaimOutcome, Study
from sim.design.h_infinity import (
    Measured,
    Norms,
    best_pd,
    central_controller,
    least_gamma,
    measured_norm,
    norms,
    pd_tabulated,
)
from sim.design.riccati_by_subspace import periodic_cost
from sim.design.theory.bodies import BODIES
from sim.validate.review import regulators
from sim.value_types import Vec3

BODY, WHEEL_NMS = BODIES[2], (0.0, 0.0, 0.05)
REVIEW = "Ovchinnikov, Roldugin 2019, sections 2.2 and 3.2"
PD_START = (6.2694e6, 1614.9)
GAMMA = {False: 2.0, True: 0.4}
"""Near the least attainable, rad, without the wheel and with it."""
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
    """The H-infinity regulator beside ``lqr``, which is that of least H2 norm, by both norms."""
    name, most_h_infinity, most_h2 = ("wheel", 0.9, 0.98) if wheel else ("three_axis", 0.75, 0.9)
    of = "with a wheel of 0.05 N m s" if wheel else "without a wheel"
    claims = (
        Claim(
            f"review.optimal.norms.{name}.h_infinity",
            f"H-infinity norm of the H-infinity regulator, {of}, over that of lqr",
            f"{REVIEW} [49, 50, 105]: least answer to the worst torque",
            "1",
            high=most_h_infinity,
        ),
        Claim(
            f"review.optimal.norms.{name}.h2",
            f"H2 norm of lqr, {of}, over that of the H-infinity regulator",
            f"{REVIEW} [48, 104]: least H2 norm",
            "1",
            high=most_h2,
        ),
    )

    def conclude(found: Sequence[Any]) -> list[ClaimOutcome]:
        lqr, h_infinity = found[0]
        return [
            claims[0].judge(h_infinity.h_infinity / lqr.h_infinity, f"{h_infinity.h_infinity:.3g} rad"),
            claims[1].judge(lqr.h2 / h_infinity.h2, f"{lqr.h2:.3g} rad"),
        ]

    return Study(f"review.optimal.norms.{name}", (partial(both_norms, wheel),), conclude)


def both_norms(wheel: bool) -> tuple[Norms, Norms]:
    """Of lqr and of the H-infinity regulator."""
    orbit = _orbit(WHEEL_NMS if wheel else (0.0, 0.0, 0.0))
    problem, field = orbit_problem(*orbit, LqrGains())
    tables = (schedule(*orbit, LqrGains()), robust_schedule(*orbit, HInfinityGains(gamma=GAMMA[wheel])))
    first, second = (norms(problem, field, table.gains[:, :, :6], _unit_nm()) for table in tables)
    return first, second


def worst_torque_gains() -> Study:
    """PD gains by the H-infinity norm."""
    claim = Claim(
        "review.optimal.pd_h_infinity",
        "H-infinity norm of the PD law, gains found by it over the best gains by Floquet theory",
        f"{REVIEW} [105]: gains with the least answer to the worst torque",
        "1",
        high=0.6,
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
        f"Miss of the torque where a limit is met, least squares over projection cut, mean of {CASES}",
        f"{REVIEW} [97]: better than the projection cut to the limits",
        "1",
        high=0.99,
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
    """The H-infinity law that sees the field alone beside LQG, which sees the same."""
    claims = (
        Claim(
            "review.optimal.measured.h_infinity",
            "H-infinity norm from torque and field's error, H-infinity law of the measured field over LQG",
            f"{REVIEW} [106]: least answer to the worst torque and error",
            "1",
            high=0.9,
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
        gamma, h_infinity, lqg = found[0]
        return [
            claims[0].judge(h_infinity / lqg, f"{h_infinity:.3g} rad"),
            claims[1].judge(h_infinity / gamma),
        ]

    return Study("review.optimal.measured", (measured_norms,), conclude)


def measured_norms() -> tuple[float, float, float]:
    """The bound, and the norms of the law made for it and of LQG."""
    problem, field = orbit_problem(*_orbit((0.0, 0.0, 0.0)), LqrGains())
    case = Measured(problem, field, _unit_nm(), ERROR * BODY.field_t)
    lqg = measured_norm(case, central_controller(case, np.inf))
    gamma, found = least_gamma(case, 0.3 * lqg, 1.1 * lqg)
    return gamma, measured_norm(case, found), lqg


def _orbit(wheel_nms: Vec3) -> tuple[Any, Vec3, float, float, float]:
    return (BODY.inertia_kgm2, wheel_nms, BODY.rate_radps, radians(BODY.inclination_deg), BODY.field_t)


def _unit_nm() -> float:
    return BODY.rate_radps**2 * float(np.trace(np.array(BODY.inertia_kgm2))) / 3.0


def _vec3(v: NDArray[np.float64]) -> Vec3:
    x, y, z = np.asarray(v).tolist()
    return (x, y, z)
