"""The rig with a coil board on a bench: its clock keeps true time, from which ticks may deviate."""

from fractions import Fraction

from fsw.core.config import FlightConfig
from fsw.wire.frame import Frame
from fsw.wire.messages import TickDone
from hil_stub.bench import DEADMAN_MS, Bench, CoilBoard
from hil_stub.coils.coil_driver import Pin
from sim.fault_rig.currents import CurrentPulse
from sim.fault_rig.rig import Rig
from sim.faults.faulty_plant import FaultyPlant
from sim.plant.coil_drive import OFF, CoilDrive
from sim.plant.config import PlantConfig
from sim.plant.hardware.actuators import Actuator
from sim.scenario.assemble import plant_config
from sim.scenario.schema import Scenario

REPEATED_EVERY_MS = 500


class BenchActuator(Actuator):
    """A coil driver on a bench in place of the plant's own, with nominal currents.

    Args:
        config: the plant's.
    """

    def __init__(self, config: PlantConfig) -> None:
        coils, limits = config.coils, config.limits
        low_a, middle_a, high_a = (dipole / coils.dipole_per_ampere_am2 for dipole in coils.levels_am2)
        self._level_a = (0.0, low_a, middle_a, high_a)
        self._period_ms = Fraction(1000, config.tick_hz)
        self._bench = Bench(lambda: CoilBoard(limits, (low_a, middle_a, high_a)), DEADMAN_MS, has_clock=True)
        self._outbox = self._bench.switch_on()
        self._pin: Pin | None = None
        self._drive = OFF
        self._on_ms = self.now_ms = 0
        self.pulses: list[CurrentPulse] = []
        """Completed pulses, over true time."""

    def begin_tick(self, tick: int, current_a: float) -> list[Frame]:
        """The frames of the bench since the last tick; it enters ticks and reads its current by itself."""
        sent, self._outbox = self._outbox, []
        return sent

    def receive(self, frame: Frame) -> None:
        """Take a frame of the bus at this instant."""
        if frame.can_id == TickDone.ID:
            self._drive = self._over_the_tick()
        self._outbox += self._bench.receive(frame, self.now_ms)
        self._note(self.now_ms)

    def wait(self, milliseconds: int) -> None:
        """Let true time pass, and note when the timer switches the pin off."""
        end_ms = self.now_ms + milliseconds
        while self.now_ms < end_ms:
            due_ms = self._bench.due_ms()
            self.now_ms = end_ms if due_ms is None else min(end_ms, max(due_ms, self.now_ms + 1))
            self._bench.watch(self.now_ms)
            self._note(self.now_ms)

    def drive(self) -> CoilDrive:
        """The currents over the tick that fsw has answered."""
        drive, self._drive = self._drive, OFF
        return drive

    def _over_the_tick(self) -> CoilDrive:
        pin = self._bench.pin
        if pin is None:
            return OFF
        current_a = self._level_a[abs(pin.level)] * (1 if pin.level > 0 else -1)
        x, y, z = (current_a if coil == pin.coil else 0.0 for coil in range(3))
        left_ms = self._period_ms if pin.until_ms is None else pin.until_ms - self.now_ms
        return CoilDrive((x, y, z), float(min(Fraction(1), left_ms / self._period_ms)))

    def _note(self, at_ms: int) -> None:
        pin = self._bench.pin
        if pin == self._pin:
            return
        if self._pin is not None:
            self.pulses.append(
                CurrentPulse(self._pin.coil, Fraction(self._on_ms, 1000), Fraction(at_ms, 1000))
            )
        self._pin, self._on_ms = pin, at_ms


class ClockRig(Rig):
    """A flight in which a fault determines the duration of each tick."""

    def __init__(self, scenario: Scenario, config: FlightConfig, seed: int) -> None:
        super().__init__(scenario, config, seed)
        config_of_plant = plant_config(scenario, seed)
        self._actuator = BenchActuator(config_of_plant)
        self._period_ms = 1000 // config_of_plant.tick_hz
        self.plant = FaultyPlant(config_of_plant, actuator=self._actuator)
        self.record.pulses_by_time = self._actuator.pulses

    def pace(self, tick: int, syncs: list[Frame]) -> None:
        """Hand SYNC to the board, and let time pass until fsw answers; repeat SYNC if the fault does."""
        board = self._actuator
        board.wait(self._period_ms if not self.plant.active else 0)
        for sync in syncs:
            board.receive(sync)
        for fault in self.plant.active:
            held_ms = fault.held_ms(tick)
            while held_ms > 0:
                board.wait(min(held_ms, REPEATED_EVERY_MS))
                held_ms -= REPEATED_EVERY_MS
                if fault.repeats_sync:
                    board.receive(syncs[0])
