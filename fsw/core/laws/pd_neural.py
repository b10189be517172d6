"""PD law whose gains are chosen in flight by two dynamic neural units, trained beforehand.

Each unit weights the sizes of error and rate by c, follows the sum with two lags in series, and gives through
its sigmoid a factor between 1 / R and R for one gain:

    s = c0 + c1 ln(1 + |E| / E0) + c2 ln(1 + |Omega| / Omega0),
    v1 <- v1 + p (s - v1),    v2 <- v2 + p (v1 - v2),    p = h / (T + h),    f = R^tanh(v2),
    m = -f_w k_w b x Omega - f_a k_a b x E,     E = 4 qv,

h a tick, T the lag, a fraction of an orbit, E0 = 0.02 and Omega0 = E0 w0. The inputs are dimensionless, so
that the weights serve any body whose k_w and k_a are near the best.

Source: Ovchinnikov, Roldugin 2019, section 3.4, after Das, Sinha, Misra 2012 (dynamic neural units choose the
gains). The review prints no equation; units and training (``sim/design/neural_training.py``) are derived.
"""

from dataclasses import dataclass
from math import log, pi, tanh

from fsw.core.algebra.vector import norm
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.pd import far_error, pd_dipole

SMALL = 0.02
"""E0: of E, which is twice the angle."""
RANGE = 8.0
"""R."""


@dataclass(frozen=True, slots=True)
class NeuralGains:
    """The weights of both units, as they were trained.

    Attributes:
        w0, w1, w2: c of the unit of k_w.
        a0, a1, a2: c of the unit of k_a.
        lag_orbits: T.
    """

    w0: float = 0.069
    w1: float = -0.01
    w2: float = -0.014
    a0: float = -0.079
    a1: float = 0.209
    a2: float = -0.351
    lag_orbits: float = 0.013

    def __post_init__(self) -> None:
        """Raises ValueError: a lag of no length."""
        if not self.lag_orbits > 0.0:
            raise ValueError("lag_orbits must be greater than 0")


def unit_inputs(error: float, rate_radps: float, orbit_rate_radps: float) -> tuple[float, float]:
    """What a unit sees: ln(1 + |E| / E0), ln(1 + |Omega| / Omega0).

    Args:
        error: |E|.
        rate_radps: |Omega|.
        orbit_rate_radps: w0.
    """
    return log(1.0 + error / SMALL), log(1.0 + rate_radps / (SMALL * orbit_rate_radps))


def neural(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The law; memory: v1 and v2 of both units, which begin at their steady state."""
    if not inputs.attitude.usable or inputs.reference is None:
        return Demand()
    gains: NeuralGains = config.gains["pd_neural"]
    omega, error = inputs.attitude.omega_body_orbit_radps, far_error(inputs.attitude.q_body_from_orbit)
    w0 = inputs.reference.orbit_rate_radps
    by_error, by_rate = unit_inputs(norm(error), norm(omega), w0)
    s_w = gains.w0 + gains.w1 * by_error + gains.w2 * by_rate
    s_a = gains.a0 + gains.a1 * by_error + gains.a2 * by_rate
    w_first, w_second, a_first, a_second = memory if len(memory) == 4 else (s_w, s_w, s_a, s_a)
    part = config.tick_s / (2.0 * pi / w0 * gains.lag_orbits + config.tick_s)
    w_first += part * (s_w - w_first)
    w_second += part * (w_first - w_second)
    a_first += part * (s_a - a_first)
    a_second += part * (a_first - a_second)
    k_w, k_a = setpoint.k_w * RANGE ** tanh(w_second), setpoint.k_a * RANGE ** tanh(a_second)
    dipole = pd_dipole(inputs.b_body_t, omega, error, k_w, k_a)
    return Demand(dipole, memory=(w_first, w_second, a_first, a_second))


LAWS = {
    "pd_neural": LawEntry(131, Aim.THREE_AXIS, neural, neural, NeuralGains),
}
