"""A reaction wheel on a rigid body: its momentum as a state, its motor with lag, its friction, its limit.

With w the wheel's axis, J_w its inertia, J that of the whole satellite and omega the body's rate:

    h = J_w (W + w . omega)        absolute momentum about its axis, W the speed against the body
    dh/dt = T - c W - T_c W / sqrt(W^2 + W_0^2)
    (J - J_w w w^T) domega/dt = T_ext - omega x ((J - J_w w w^T) omega + h w) - w dh/dt

so that what the wheel gains the body loses, and their total momentum is conserved without other torques.

Source: Hughes 1986, Spacecraft Attitude Dynamics, chapter 6 (gyrostats). The Coulomb friction is smoothed
about W = 0.
"""

from math import exp, sqrt
from typing import final

from sim.plant.rotation import Vec3
from sim.plant.wheel_config import WheelConfig

SMOOTH_RADPS = 1.0
"""W_0: at lower speeds the Coulomb friction is smaller."""


@final
class WheelStep:
    """What the wheel does to the body over an integration step, body axes.

    Args:
        start_nms: h w at its start.
        middle_nms: in its middle.
        end_nms: at its end.
        reaction_nm: -w dh/dt.
    """

    __slots__ = ("end_nms", "middle_nms", "reaction_nm", "start_nms")

    def __init__(self, start_nms: Vec3, middle_nms: Vec3, end_nms: Vec3, reaction_nm: Vec3) -> None:
        self.start_nms = start_nms
        self.middle_nms = middle_nms
        self.end_nms = end_nms
        self.reaction_nm = reaction_nm


@final
class SpinningWheel:
    """The wheel's own state: absolute momentum about its axis, and the torque that its motor gives.

    Args:
        config: the wheel.
        omega_body_radps: the body's inertial rate at the epoch.
    """

    def __init__(self, config: WheelConfig, omega_body_radps: Vec3) -> None:
        self._config = config
        self._momentum_nms = config.momentum_nms + config.inertia_kgm2 * self._along(omega_body_radps)
        self._motor_nm = 0.0

    def relative_nms(self, omega_body_radps: Vec3) -> float:
        """J_w W: its momentum relative to the body, along its axis."""
        return self._momentum_nms - self._config.inertia_kgm2 * self._along(omega_body_radps)

    def advance(self, requested_nm: float, omega_body_radps: Vec3, step_s: float) -> WheelStep:
        """One integration step, over which its momentum changes linearly.

        The motor torque follows the request exponentially; friction is that at the speed in the middle, and
        can at most stop the wheel. No motor torque carries the relative momentum over its limit.

        Args:
            requested_nm: motor torque that the board asks for.
            omega_body_radps: the body's inertial rate at the start.
            step_s: length of the step.
        """
        config, h = self._config, self._momentum_nms
        before = self.relative_nms(omega_body_radps)
        motor_nm = self._mean_motor_nm(requested_nm, step_s)
        free = before + step_s * motor_nm
        friction_nm = self.friction_nm(before / config.inertia_kgm2)
        middle = _slow(0.5 * (before + free), 0.5 * step_s * friction_nm)
        if middle:  # otherwise friction stops it within the step
            friction_nm = self.friction_nm(middle / config.inertia_kgm2)
        most = max(config.max_momentum_nms, abs(before))
        after = min(max(_slow(free, step_s * friction_nm), -most), most)
        change = after - before
        self._momentum_nms = h + change
        axis = config.axis_body
        return WheelStep(
            _scale(h, axis),
            _scale(h + 0.5 * change, axis),
            _scale(h + change, axis),
            _scale(-change / step_s, axis),
        )

    def friction_nm(self, speed_radps: float) -> float:
        """The torque that slows the wheel at a speed relative to the body; it has the sign of the speed."""
        smooth = speed_radps / sqrt(speed_radps * speed_radps + SMOOTH_RADPS * SMOOTH_RADPS)
        return self._config.viscous_nms * speed_radps + self._config.coulomb_nm * smooth

    def _mean_motor_nm(self, requested_nm: float, step_s: float) -> float:
        """The mean motor torque over a step; the motor torque itself is advanced to its end."""
        config = self._config
        limit = config.max_torque_nm
        wanted = min(max(config.torque_scale * requested_nm, -limit), limit)
        lag = config.time_constant_s
        if lag <= 0.0:
            self._motor_nm = wanted
            return wanted
        lacking, kept = self._motor_nm - wanted, exp(-step_s / lag)
        self._motor_nm = wanted + lacking * kept
        return wanted + lacking * (1.0 - kept) * lag / step_s

    def _along(self, v: Vec3) -> float:
        x, y, z = self._config.axis_body
        return x * v[0] + y * v[1] + z * v[2]


def _scale(size: float, v: Vec3) -> Vec3:
    return (size * v[0], size * v[1], size * v[2])


def _slow(momentum_nms: float, lost_nms: float) -> float:
    """The momentum after a loss to friction, which does not reverse it."""
    turned = lost_nms * momentum_nms > 0.0 and abs(lost_nms) > abs(momentum_nms)
    return 0.0 if turned else momentum_nms - lost_nms
