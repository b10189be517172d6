"""Flights of a satellite with a pitch wheel, from a lean away from the orbit normal."""

import numpy as np
import pytest

WHEEL_NMS = 0.05
INERTIA = np.diag([1.9, 1.95, 2.0])


class Lean:
    """A flight and what came of the wheel's axis."""

    def __init__(self, run, normal_eci, orbit_ticks):
        self.run = run
        self.lean_deg = run.axis_to_deg(2, normal_eci)
        self.orbit_ticks = orbit_ticks

    def most_deg(self, orbit):
        """The largest lean of an orbit, from 0."""
        return self.lean_deg[orbit * self.orbit_ticks : (orbit + 1) * self.orbit_ticks].max()

    def mean_angles_deg(self):
        """Yaw, roll and pitch on the mean of the last orbit."""
        c = self.run.c_body_from_orbit[-self.orbit_ticks :]
        s = np.stack([c[:, 1, 2] - c[:, 2, 1], c[:, 2, 0] - c[:, 0, 2], c[:, 0, 1] - c[:, 1, 0]], axis=1)
        return np.degrees(0.5 * s.mean(axis=0))


@pytest.fixture(scope="session")
def lean(bench, turned):
    """Fly a law with its gains from a turn about an axis, at a rate beside that of the orbit."""

    def fly(
        law,
        *,
        gains=None,
        angle_deg=10.0,
        axis=(1, 1, 0.3),
        relative=(0.0, 0.0, 0.0),
        inclination_deg=98.6,
        orbits=2.0,
        step_s=8.0,
        k_w=1e7,
        k_a=4000.0,
        k_i=0.0,
        **body,
    ):
        orbit, c0 = bench.Orbit(inclination_deg=inclination_deg), turned(axis, angle_deg)
        run = bench.fly(
            law,
            bench.setpoint(k_w=k_w, k_a=k_a, k_i=k_i),
            gains={law.__name__: gains},
            orbit=orbit,
            body=bench.Body(inertia=INERTIA, wheel=(0.0, 0.0, WHEEL_NMS), **body),
            c_body_from_orbit=c0,
            omega_body=np.array(relative) + orbit.rate_radps * c0[:, 2],
            seconds=orbits * orbit.period_s,
            step_s=step_s,
        )
        return Lean(run, orbit.c_orbit_from_eci(0.0)[2], int(orbit.period_s / step_s))

    return fly
