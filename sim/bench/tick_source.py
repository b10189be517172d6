"""The source of the ticks of a bench, and of what its sensors see: the plant in real time, or SYNC alone."""

import os
from collections.abc import Callable, Mapping
from typing import Protocol

from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CLASSES,
    SENDERS,
    CoilDipoleStatus,
    CoilFire,
    CoilStatus,
    MagField,
    PlantBoot,
    SunCells,
    SunVector,
    Sync,
    intact,
)
from sim.plant.coil_drive import OFF, CoilDrive
from sim.plant.config import PlantConfig
from sim.plant.hardware.actuators import Actuator
from sim.plant.own_effects import NO_EFFECTS, OwnEffects
from sim.plant.plant import Plant

SENSORS = {MagField.ID: "magnetometer", SunVector.ID: "sun", SunCells.ID: "cells"}
"""By the message that they send."""
Line = Callable[[bytes], None]
"""Writes a line to a sensor's standard input."""


class TickSource(Protocol):
    """In each tick: ``frames``; then ``receive`` what is on the bus; then ``advance`` to the next tick."""

    def frames(self) -> list[Frame]:
        """The frames of this tick, SYNC last."""

    def receive(self, frame: Frame) -> bool:
        """Take a frame of the bus: whether it is the coil board's status of this tick."""

    def advance(self) -> None:
        """Advance to the next tick, with the status of the coil board if it has sent one."""


class SyncOnly:
    """SYNC without physics: the sensors have stimuli of their own."""

    def __init__(self, epoch_unix_s: int, tick_hz: int) -> None:
        self._epoch_unix_s = epoch_unix_s
        self._tick_hz = tick_hz
        self._tick = 0

    def frames(self) -> list[Frame]:
        """SYNC."""
        return [Sync(self._tick, self._epoch_unix_s + self._tick // self._tick_hz).encode()]

    def receive(self, frame: Frame) -> bool:
        """Nothing depends on the bus."""
        return False

    def advance(self) -> None:
        """The next tick."""
        self._tick += 1


class ReportedDrive(Actuator):
    """The plant's actuator where the coil board is a process or hardware: what its COIL_STATUS reports.

    Args:
        config: the plant.
    """

    def __init__(self, config: PlantConfig) -> None:
        coils = config.coils
        self._tick_ms = 1000.0 / config.tick_hz
        self._level_a = [0.0, *(dipole / coils.dipole_per_ampere_am2 for dipole in coils.levels_am2)]
        self._continuous = coils.continuous
        self._dipole_per_ampere = coils.dipole_per_ampere_am2
        self._requested_ms = 0
        self._left_ms = 0
        self._driven = OFF

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """Nothing: the board sends its own frames."""
        return []

    def receive(self, frame: Frame) -> None:
        """Nothing: the board receives its own frames."""

    def drive(self) -> CoilDrive:
        """What the board reported for this tick, once; off where it has reported nothing."""
        driven, self._driven = self._driven, OFF
        return driven

    def take(self, frame: Frame) -> bool:
        """Take what concerns the coils: whether the frame was the board's status of a tick."""
        if not intact(frame):
            return False
        if frame.can_id == CoilFire.ID:
            self._requested_ms = CoilFire.decode(frame.data).duration_ms
        elif frame.can_id == CoilStatus.ID and self._continuous is None:
            self._driven = self._pulse(CoilStatus.decode(frame.data))
            return True
        elif frame.can_id == CoilDipoleStatus.ID and self._continuous is not None:
            status, full_a = CoilDipoleStatus.decode(frame.data), self._full_a
            current_a = (status.m_x * full_a, status.m_y * full_a, status.m_z * full_a)
            self._driven = CoilDrive(current_a, self._continuous.on_fraction)
            return True
        return False

    @property
    def _full_a(self) -> float:
        return self._continuous.max_dipole_am2 / self._dipole_per_ampere if self._continuous else 0.0

    def _pulse(self, status: CoilStatus) -> CoilDrive:
        """The last tick of a pulse is driven for the rest of it: as reported a tick ago, or as requested."""
        before_ms, self._left_ms = self._left_ms, status.remaining_ms
        if not status.level or abs(status.level) >= len(self._level_a):
            return OFF
        part_ms = self._tick_ms if status.remaining_ms else before_ms or self._requested_ms
        current_a = self._level_a[abs(status.level)] * (1.0 if status.level > 0 else -1.0)
        x, y, z = (current_a if coil == status.coil else 0.0 for coil in range(3))
        return CoilDrive((x, y, z), min(1.0, part_ms / self._tick_ms))


class PlantTicks:
    """The plant; the sensors are shown what it computes.

    Args:
        config: the plant.
        lines: by name of a sensor, what writes lines to it; one without is real, and so is what it sees.
        own: user effects; of those on sensors none, for the sensors are boards.
    """

    def __init__(
        self,
        config: PlantConfig,
        lines: Mapping[str, Line],
        own: OwnEffects = NO_EFFECTS,
    ) -> None:
        self._drive = ReportedDrive(config)
        self._plant = Plant(config, self._drive, own)
        self._lines = lines
        self._own: list[Frame] = []
        self._show()

    def frames(self) -> list[Frame]:
        """The plant's own frames of this tick, SYNC last."""
        return self._own

    def receive(self, frame: Frame) -> bool:
        """Take a frame of the bus: whether the board has reported what was driven in this tick."""
        return self._drive.take(frame)

    def advance(self) -> None:
        """Integrate over this tick, and show the sensors the instant of the next."""
        self._plant.end_tick()
        self._show()

    def _show(self) -> None:
        tick = self._plant.tick
        self._own = []
        for frame in self._plant.begin_tick():
            if SENDERS[frame.can_id] == "PLANT":
                self._own += [frame] if frame.can_id != PlantBoot.ID else []  # all have booted by now
            elif write := self._lines.get(SENSORS.get(frame.can_id, "")):
                valid, *values, _ = CLASSES[frame.can_id].decode(frame.data).values()
                write(f"{tick} {' '.join(map(repr, values))} {valid}\n".encode())


def line_to(descriptor: int) -> Line:
    """Writes lines into a pipe without blocking; where nothing reads it, the lines are dropped."""

    def write(line: bytes) -> None:
        try:
            os.write(descriptor, line)
        except (BlockingIOError, BrokenPipeError):
            return

    return write
