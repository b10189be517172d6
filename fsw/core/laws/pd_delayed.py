"""PD law without a measured rate: the attitude now and some time ago give it.

With q now and q_T of a time T earlier, as W(q)^T q = 0 for W of ``output_feedback``,

    Omega_T = 2 W(q)^T (q - q_T) / T,     m = -k_w b x Omega_T - k_a b x E,     E = 4 qv.

Omega_T is the mean rate over the last T and lags by T / 2. The attitude is kept every ``delay_s``, so that T
lies between once and twice that (less after the first attitude): two attitudes in memory, not one per tick.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Xu, Luo, Yang 2017 (delayed output feedback). The
review prints no equation; this one is derived.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.output_feedback import lagged_rate, nearer_sign
from fsw.core.laws.pd import far_error, pd_dipole


@dataclass(frozen=True, slots=True)
class DelayGains:
    """Least delay, s: long against the noise of the attitude, short against an orbit."""

    delay_s: float = 60.0

    def __post_init__(self) -> None:
        """Raises ValueError: no delay."""
        if self.delay_s <= 0.0:
            raise ValueError("delay_s must be greater than 0")


def mean_rate(
    q_body_from_orbit: Quaternion, earlier: Quaternion, interval_s: float
) -> tuple[float, float, float]:
    """Omega_T = 2 W(q)^T (q - q_T) / T, body axes, rad/s.

    Args:
        q_body_from_orbit: q.
        earlier: q_T; of q_T and -q_T the one nearer to q is taken.
        interval_s: T, greater than 0.
    """
    return lagged_rate(q_body_from_orbit, nearer_sign(earlier, q_body_from_orbit), 1.0 / interval_s)


def delayed(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The PD law on the mean rate; memory: tick and attitude of the older and of the newer kept attitude."""
    if not inputs.attitude.usable:
        return Demand()
    q, now = inputs.attitude.q_body_from_orbit, float(inputs.tick)
    gains: DelayGains = config.gains["pd_delayed"]
    older_tick, o0, o1, o2, o3, newer_tick, *newer = memory if len(memory) == 10 else (now, *q, now, *q)
    interval_s = (now - older_tick) * config.tick_s
    omega = mean_rate(q, (o0, o1, o2, o3), interval_s) if interval_s > 0.0 else (0.0, 0.0, 0.0)
    dipole = pd_dipole(inputs.b_body_t, omega, far_error(q), setpoint.k_w, setpoint.k_a)
    if (now - newer_tick) * config.tick_s >= gains.delay_s:
        return Demand(dipole, memory=(newer_tick, *newer, now, *q))
    return Demand(dipole, memory=(older_tick, o0, o1, o2, o3, newer_tick, *newer))


LAWS = {
    "pd_delayed": LawEntry(57, Aim.THREE_AXIS, delayed, delayed, DelayGains),
}
