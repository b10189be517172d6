"""The wheel of the plant: its board on the bus, and the wheel that it drives."""

from typing import final

from fsw.wire.frame import Frame
from hil_stub.wheel.wheel_driver import WheelDriver
from hil_stub.wheel.wheel_guard import WheelLimits
from sim.plant.dynamics.wheel import SpinningWheel, WheelStep
from sim.plant.rotation import Vec3
from sim.plant.wheel_config import WheelConfig


@final
class WheelUnit:
    """Board and wheel.

    In each tick: ``begin_tick``, ``receive`` for each frame, ``drive``, then ``advance`` for each substep.

    Args:
        config: the wheel.
        tick_hz: ticks a second.
        omega_body_radps: the body's inertial rate at the epoch.
    """

    def __init__(self, config: WheelConfig, tick_hz: int, omega_body_radps: Vec3) -> None:
        self._config, self._tick_hz = config, tick_hz
        self._wheel = SpinningWheel(config, omega_body_radps)
        self.restart()
        self._torque_nm = 0.0

    def restart(self) -> None:
        """Power-cycle the board; the wheel keeps turning."""
        config = self._config
        limits = WheelLimits(
            self._tick_hz, config.max_torque_nm, config.max_momentum_nms / config.inertia_kgm2
        )
        self._board = WheelDriver(limits)

    def begin_tick(self, tick: int, omega_body_radps: Vec3) -> list[Frame]:
        """The frames of its board in this tick."""
        return self._board.begin_tick(tick, self.momentum_nms(omega_body_radps) / self._config.inertia_kgm2)

    def receive(self, frame: Frame) -> None:
        """Hand its board a frame of the bus."""
        self._board.receive(frame)

    def drive(self) -> None:
        """The tick's answers are complete: the torque of this tick is what its board lets through."""
        self._torque_nm = self._board.drive()

    def advance(self, omega_body_radps: Vec3, step_s: float) -> WheelStep:
        """One integration step."""
        return self._wheel.advance(self._torque_nm, omega_body_radps, step_s)

    def momentum_nms(self, omega_body_radps: Vec3) -> float:
        """Its momentum relative to the body, along its axis."""
        return self._wheel.relative_nms(omega_body_radps)
