"""The shipped scheduler in the form that ``audit_scheduler`` tests, alone or behind a law of your own."""

from collections.abc import Sequence

from fsw.core.actuation import pulses
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate, update_view
from fsw.core.actuation.pulses import PulseConfig, PulseState
from fsw.core.gate.calibration import NO_CALIBRATION, measure
from fsw.core.gate.readings import Readings
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, Memory
from fsw.core.laws.plan.pulse_model import AXES
from fsw.own_law import Law
from fsw.table.own_law import whole
from fsw.wire.messages import CoilBoot, CoilFire
from sim.testing.scheduler_flight import Fire, Heard, Limits, MakeScheduler, Scheduler

LEVELS_AM2 = (0.5, 2.0, 8.0)
LEAK_S = 300.0
_BOOTED = CoilBoot(reason=0, version=1, table_crc=0)


class UnsoundLawError(AssertionError):
    """A law has asked for something that is not a finite number."""


class ShippedScheduler:
    """``fsw.core``'s scheduler, at given limits.

    Raises:
        ValueError: a pulse is shorter than a tick.
    """

    def __init__(self, limits: Limits) -> None:
        timing = pulses.pulse_timing(limits.tick_hz, limits.pulse_ms, limits.backoff_ms)
        pulse_ticks, backoff_ticks, duration_ms = timing
        self._config = ActuatorConfig(
            PulseConfig(
                pulse_ticks=pulse_ticks,
                backoff_ticks=backoff_ticks,
                duration_ms=duration_ms,
                shared=limits.shared,
                levels_am2=LEVELS_AM2,
                pulse_s=duration_ms / 1000.0,
                tick_s=1.0 / limits.tick_hz,
                leak_s=LEAK_S,
                rate_metric=AXES,
                energy_metric=AXES,
            ),
            dipoles=None,
        )
        self._state: PulseState | None = None
        self._view = CoilView()

    def step(self, heard: Heard) -> Sequence[Fire]:
        """As in flight: the owed impulse grows by the demand, and a pulse pays it when one is allowed."""
        return self.step_with_demand(heard, Demand(heard.m_body_am2))

    def step_with_demand(self, heard: Heard, demand: Demand) -> Sequence[Fire]:
        """The same for this demand in place of that of the flight."""
        if self._state is None:
            self._state = pulses.boot(heard.tick, self._config.pulses)
        readings = Readings(coil=heard.status, coil_boot=_BOOTED if heard.booted else None)
        measurements = measure(readings, NO_CALIBRATION)
        update_view(self._view, measurements, heard.tick, self._config)
        request = actuate(
            self._state, self._view, demand, heard.b_body_t, measurements, heard.tick, self._config
        )
        if not isinstance(request, CoilFire):
            return ()
        return (Fire(request.coil, request.level, request.duration_ms),)


class _SchedulerUnderLaw:
    """The shipped scheduler with the demands of a law."""

    def __init__(self, limits: Limits, law: Law, control: ControlConfig) -> None:
        self._scheduler = ShippedScheduler(limits)
        self._law = law
        self._control = control
        self._memory: Memory = ()
        self._sample = FieldSample()

    def step(self, heard: Heard) -> Sequence[Fire]:
        """Ask the law for its demand, and the scheduler for requests."""
        before, self._sample = self._sample, FieldSample(heard.b_body_t, heard.tick)
        law_input = LawInput(heard.attitude, heard.b_body_t, self._sample, before, tick=heard.tick)
        answer = self._law(law_input, self._memory, self._control.setpoint, self._control)
        try:
            demand = whole(answer)
        except ValueError as error:
            raise UnsoundLawError(f"tick {heard.tick}: {error}, for {law_input}") from None
        self._memory = demand.memory
        return self._scheduler.step_with_demand(heard, demand)


def scheduler_under(law: Law, control: ControlConfig) -> MakeScheduler:
    """Make the shipped scheduler with a law before it, which can be tested as a scheduler."""

    def make(limits: Limits) -> Scheduler:
        return _SchedulerUnderLaw(limits, law, control)

    return make
