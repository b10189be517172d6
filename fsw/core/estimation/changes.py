"""What changes in orbit: by how much it widens the estimate, where, and what fades.

Bias and residual dipole step at the shadow's edge, where temperatures and currents change, and the body may
snap; the field model is wrong where the currents of a storm flow, at high geomagnetic latitude; a coil keeps
another part of each pulse. None has a parameter of its own: the covariance of those that it moves grows by
what the table's bounds allow. The light of the Earth, and what it adds to a Sun cell, are states, which go
back to their means as the satellite passes over other clouds.
"""

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from fsw.core.algebra.vector import Vec3, dot, is_zero, norm
from fsw.core.estimation.kalman import Matrix
from fsw.core.estimation.kalman import fade as fade_covariance
from fsw.core.estimation.mekf import Estimate
from fsw.core.estimation.mekf_config import MekfConfig
from fsw.core.orbit.earth import RADIUS_M
from fsw.core.orbit.ephemeris import Reference
from fsw.core.orbit.sun import lit

EDGE_M: Final = 60e3
"""By so much the shadow's edge may be off that of a cylinder of the Earth's radius: half the penumbra, the
flattening, air, an error of the position."""
EDGE_S: Final = 18.0
"""What the satellite takes at least for twice that way."""
CORRELATION_RAD: Final = 1.0
"""After a rotation by this angle the excess of a cell is little correlated with that before."""
ORBIT_RADPS: Final = 1.1e-3
"""The Earth moves at this rate in the view of a satellite that does not turn."""
STORMY_SINE: Final = 0.894
"""Of the field's dip: above it, from 45 deg of geomagnetic latitude on, tan(dip) = 2 tan(latitude), storms
disturb the field."""


@final
@dataclass(frozen=True, slots=True)
class Changes:
    """How variances grow: of bias, dipole and rate at the shadow's edge, of the bias where it is stormy.

    ``walk_t2ps``: of the bias at all times, by which the filter's own walk grows where it is eased.

    ``remanent_ps``: of the dipole that a coil keeps, as a part of the square of the dipole driven, 1/s;
    ``edge_rate``: of the rate, rad^2/s^3, (3, 3).
    """

    walk_t2ps: float
    edge_bias_t2ps: float
    edge_dipole_a2m4ps: float
    storm_t2ps: float
    remanent_ps: float
    edge_rate: Matrix | None


NO_CHANGES: Final = Changes(0.0, 0.0, 0.0, 0.0, 0.0, None)


def widen(
    estimate: Estimate,
    reference: Reference,
    m_body_am2: Vec3,
    config: MekfConfig,
    changes: Changes,
    eased: float = 1.0,
) -> None:
    """Add to the covariance what a tick may have changed.

    Args:
        estimate: predicted over the tick.
        reference: of its end.
        m_body_am2: dipole driven in it, body axes.
        config: the filter.
        changes: the variances.
        eased: factor on them.
    """
    if changes is NO_CHANGES:
        return
    parts, h, grown = config.layout, config.tick_s * eased, []
    if parts.mag_bias is not None and eased > 1.0:
        grown.append((parts.mag_bias, np.eye(3) * (changes.walk_t2ps * (h - config.tick_s))))
    if _is_at_edge(reference):
        if parts.mag_bias is not None:
            grown.append((parts.mag_bias, np.eye(3) * (changes.edge_bias_t2ps * h)))
        if parts.dipole is not None:
            grown.append((parts.dipole, np.eye(3) * (changes.edge_dipole_a2m4ps * h)))
        if changes.edge_rate is not None:
            grown.append((slice(3, 6), changes.edge_rate * h))
    if parts.mag_bias is not None and _is_stormy(reference):
        grown.append((parts.mag_bias, np.eye(3) * (changes.storm_t2ps * h)))
    if parts.dipole is not None and not is_zero(m_body_am2):
        x, y, z = m_body_am2
        part = changes.remanent_ps * h
        grown.append((parts.dipole, np.diag([part * x * x, part * y * y, part * z * z])))
    if not grown:
        return
    covariance = estimate.covariance.copy()
    for place, more in grown:
        covariance[place, place] += more
    estimate.covariance = covariance


def fade(estimate: Estimate, config: MekfConfig) -> None:
    """Let excess and Earth's light decay over a tick, towards their mean.

    First-order Markov processes: x <- k x, sigma^2 <- k^2 sigma^2 + (1 - k^2) sigma_0^2, k = 1 / (1 + turn);
    turn is the Earth's motion in view, for the excess of a cell plus the rotation of the satellite. What a
    deviation has left in x decays as x does.
    """
    parts, known = config.layout, estimate.parameters
    passed = config.tick_s * ORBIT_RADPS / CORRELATION_RAD
    if parts.cells is not None:
        turned = passed + config.tick_s * norm(estimate.omega_body_radps) / CORRELATION_RAD
        of_excess = 1.0 / (1.0 + turned)
        known.cell_excess = tuple([of_excess * value for value in known.cell_excess])
        _fade(estimate, parts.cells, of_excess, config)
    if parts.earth_light is not None:
        of_light, mean = 1.0 / (1.0 + passed), config.initial_parameters.earth_light[0]
        known.earth_light = (mean + of_light * (known.earth_light[0] - mean),)
        _fade(estimate, parts.earth_light, of_light, config)


def _fade(estimate: Estimate, place: slice, keep: float, config: MekfConfig) -> None:
    """Scale these states in covariance and trace by ``keep``, their variances nearer to the prior's."""
    estimate.covariance = fade_covariance(estimate.covariance, config.initial_covariance, place, keep)
    if estimate.trace is not None:
        effect = estimate.trace.effect.copy()
        effect[place] *= keep
        estimate.trace.effect = effect


def _is_at_edge(reference: Reference) -> bool:
    """Whether the satellite may be crossing the edge of the Earth's shadow."""
    r, s = reference.r_eci_m, reference.sun_eci
    return lit(r, s, RADIUS_M - EDGE_M) != lit(r, s, RADIUS_M + EDGE_M)


def _is_stormy(reference: Reference) -> bool:
    r, b = reference.r_eci_m, reference.b_eci_t
    return abs(dot(r, b)) > STORMY_SINE * norm(r) * norm(b)
