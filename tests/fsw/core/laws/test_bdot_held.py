"""B-dot with a held torque: the torque is what is set until the gain is at its largest."""

import numpy as np
import pytest

from fsw.core.laws.bdot_held import HeldGains, bdot_held, held_gain
from fsw.core.laws.damping import bdot


@pytest.mark.parametrize("rate_radps", [0.05, 0.02, 0.004])
def test_the_torque_does_not_fall_with_the_rate(rate_radps):
    """|m x b| with m = -k db/dt, whatever the rate across the field."""
    b = np.array([1e-5, -2e-5, 3e-5])
    b_dot = np.cross(b, rate_radps * np.array([0.6, 0.8, 0.0]))
    gain = held_gain(tuple(b_dot), tuple(b), 3e-5, 1e9)
    assert np.linalg.norm(np.cross(-gain * b_dot, b)) == pytest.approx(3e-5)


def test_the_gain_stops_growing():
    """At |db/dt| |b| = M / most, 1e-5 / 1e7 = 1e-12."""
    b = (0.0, 0.0, 2e-5)
    assert held_gain((0.9e-12 / 2e-5, 0.0, 0.0), b, 1e-5, 1e7) == 1e7
    assert held_gain((4e-12 / 2e-5, 0.0, 0.0), b, 1e-5, 1e7) == pytest.approx(2.5e6)
    assert held_gain((0.0, 0.0, 0.0), b, 1e-5, 1e7) == 1e7


@pytest.mark.long
class TestFlights:
    @pytest.fixture
    def flown(self, bench):
        def fly(law, k_w, gains=None):
            return bench.fly(
                law,
                bench.setpoint(k_w=k_w),
                gains=gains,
                body=bench.Body(gravity=False),
                omega_body=(0.02, -0.03, 0.025),
                seconds=9000.0,
            )

        return fly

    def test_the_energy_falls_in_every_two_minutes_while_the_body_is_fast(self, flown):
        run = flown(bdot_held, 6e5, {"bdot_held": HeldGains(30.0, 20.0)})
        fast = np.linalg.norm(run.omega_body, axis=1)[:-30:30] > 0.012
        assert fast.sum() > 10
        assert np.all(np.diff(run.energy_j[::30])[fast] < 0.0)

    def test_it_is_slow_long_before_the_same_gain_fixed(self, flown):
        """Both begin with about the same torque."""
        fixed = flown(bdot, 6e5)
        held = flown(bdot_held, 6e5, {"bdot_held": HeldGains(30.0, 20.0)})
        rate = [np.linalg.norm(run.omega_body, axis=1) for run in (fixed, held)]
        share = [r / r[0] for r in rate]
        assert np.argmax(share[1] < 0.3) < 0.75 * np.argmax(share[0] < 0.3)
        assert share[1][-1] < 0.1 < share[0][-1]


@pytest.mark.parametrize("values", [{"torque_unm": 0.0}, {"most": -1.0}, {"most": float("nan")}])
def test_gains_without_sense_are_refused(values):
    with pytest.raises(ValueError, match="must be positive"):
        HeldGains(**values)
