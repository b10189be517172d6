"""What the flight software in C is to answer: functions of ``fsw.core``, in double precision."""

import re
from copy import copy
from dataclasses import dataclass, field
from typing import NamedTuple

from detumble_bench import FIRMWARE

from fsw.core.actuation import pulses, read_back
from fsw.core.actuation.actuator import ActuatorConfig, CoilView, actuate, update_view
from fsw.core.actuation.pulses import PulseConfig, PulseState
from fsw.core.actuation.read_back import ReadBackConfig
from fsw.core.algebra.vector import ZERO, Vec3, add, cross, dot, norm, row, scale, transform
from fsw.core.estimation.attitude import UNKNOWN
from fsw.core.estimation.orbital_attitude import perfect_attitude
from fsw.core.gate.calibration import NO_CALIBRATION, measure
from fsw.core.gate.readings import GateState, admit
from fsw.core.laws.damping import bdot_dipole
from fsw.core.laws.interface import Demand, FieldSample
from fsw.core.laws.pd import far_error, integrate_error, pd_dipole, within_mean_dipole
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.wire.messages import CoilFire, Sync

OLD_S = 10.0
"""Field samples further apart, or older, are not used."""


class Gains(NamedTuple):
    """The values of ``detumble_gains.h``."""

    k_w: float
    k_a: float
    k_i: float
    near_rad: float
    leak_s: float
    slow_radps: float
    fast_radps: float
    off_ma: float
    blank_ticks: float


def gains_that_ship():
    """Those of the header."""
    text = (FIRMWARE / "gains" / "detumble_gains.h").read_text()
    values = {
        name.lower(): float(value) for name, value in re.findall(r"#define GAINS_(\w+) ([\d.e-]+)", text)
    }
    return Gains(**values)


def pulse_gaps(impulse_body_nms, b_body_t, config: PulseConfig, may_fire):
    """By pulse and for none, how much more it leaves than the best, as part of what the strongest changes."""
    changes, largest = {Pulse(0, 0): 0.0}, 0.0
    weighted = transform(config.rate_metric, impulse_body_nms)
    for coil in (coil for coil in range(3) if may_fire[coil]):
        gain = scale(config.pulse_s, cross(row(config.coil_axes, coil), b_body_t))
        along, square = dot(weighted, gain), dot(gain, transform(config.rate_metric, gain))
        for number, level_am2 in enumerate(config.levels_am2, 1):
            for level in (number, -number):
                signed = along if level > 0 else -along
                changes[Pulse(coil, level)] = level_am2 * (level_am2 * square - 2.0 * signed)
            largest = max(largest, level_am2 * level_am2 * square)
    least = min(changes.values())
    return {(pulse.coil, pulse.level): (change - least) / largest for pulse, change in changes.items()}


@dataclass
class Reference:
    """The same chain in Python, tick by tick; all ticks are answered.

    Where C has answered otherwise, ``follow`` takes what C did for done, so that each later tick is compared
    for itself.
    """

    config: PulseConfig
    gains: Gains
    gate: GateState = field(default_factory=GateState)
    view: CoilView = field(default_factory=CoilView)
    sample: FieldSample = field(default_factory=FieldSample)
    state: PulseState | None = None
    pointing: bool = False
    integral_s: Vec3 = ZERO

    def answer(self, incoming):
        """The request in answer to the frames of a tick, the last of which is SYNC; None: there is none."""
        tick = Sync.decode(incoming[-1].data).tick
        measurements = measure(admit(tuple(incoming), self.gate), NO_CALIBRATION)
        read_back.remove_offset(measurements, self.view, tick, ReadBackConfig(self.gains.off_ma, 0))
        update_view(self.view, measurements, tick, ActuatorConfig(self.config, None))
        if self.state is None:
            self.state = pulses.boot(tick, self.config)
        before, self.sample = self.sample, self._sample(measurements, tick)
        coil = measurements.coil
        stuck = coil is not None and coil.level == 0 and coil.current_ma != 0
        dipole = self._dipole(perfect_attitude(measurements, UNKNOWN), before, tick)
        demand, b = None if stuck else Demand(dipole), self.sample.b_body_t
        self._before = copy(self.state), copy(self.view), demand, b, tick
        limits = ActuatorConfig(self.config, None)
        return actuate(self.state, self.view, demand, b, measurements, tick, limits)

    def gaps(self):
        """Of the tick that was answered last, ``pulse_gaps``; empty where no coil might fire."""
        state, _, demand, b, tick = self._before
        may_fire = [wait == 0 for wait in pulses.wait_ticks(state, tick)]
        if demand is None or not any(may_fire) or norm(b) == 0.0:
            return {}
        owed, torque = copy(state), cross(demand.m_body_am2, b)
        pulses.owe(owed, torque, b, self.config)
        return pulse_gaps(pulses.due(owed, torque, b, self.config), b, self.config, may_fire)

    def follow(self, fire):
        """C has fired this, or nothing, in place of what was answered."""
        self.state, self.view, demand, b, tick = self._before
        pulses.owe(self.state, cross(demand.m_body_am2, b), b, self.config)
        if fire is not None:
            pulse = Pulse(fire.coil, fire.level)
            self.view.fired_tick, self.view.fired = tick, pulse
            self.view.paid_body_nms = pulses.impulse(pulse, b, self.config)
            pulses.fire(self.state, pulse, self.view.paid_body_nms, tick, self.config)

    def _sample(self, measurements, tick):
        reading, coil = measurements.field, measurements.coil
        off = coil is not None and coil.level == 0 and coil.current_ma == 0
        quiet = off and self.view.idle_ticks > self.gains.blank_ticks
        usable = reading is not None and reading.valid and quiet
        return FieldSample(reading.b_body_t, tick) if usable else self.sample

    def _dipole(self, attitude, before, tick):
        now, gains = self.sample, self.gains
        most_radps = gains.fast_radps if self.pointing else gains.slow_radps
        self.pointing = attitude.usable and norm(attitude.omega_body_orbit_radps) < most_radps
        self.integral_s = self.integral_s if self.pointing else ZERO
        apart_s = (now.tick - before.tick) * self.config.tick_s
        if now.tick < 0 or (tick - now.tick) * self.config.tick_s > OLD_S:
            return ZERO
        if self.pointing:
            return self._pointing(attitude, now.b_body_t)
        if before.tick >= 0 and 0.0 < apart_s <= OLD_S:
            return bdot_dipole(now.b_body_t, before.b_body_t, apart_s, gains.k_w)
        return ZERO

    def _pointing(self, attitude, b):
        error, gains, config = far_error(attitude.q_body_from_orbit), self.gains, self.config
        share = config.pulse_ticks / (config.pulse_ticks + config.backoff_ticks)
        most_am2 = config.levels_am2[2] * share
        if norm(error) < 2.0 * gains.near_rad:
            self.integral_s = integrate_error(self.integral_s, error, b, gains.k_i, config.tick_s, most_am2)
        self.integral_s = within_mean_dipole(self.integral_s, b, gains.k_i, most_am2)
        held = cross(scale(gains.k_i, self.integral_s), b)
        limited = within_mean_dipole(error, b, gains.k_a, most_am2)
        return add(pd_dipole(b, attitude.omega_body_orbit_radps, limited, gains.k_w, gains.k_a), held)


class Difference(NamedTuple):
    """A tick in which C answers otherwise.

    ``gap``: how much more the pulse of C leaves than the best, in parts of what the strongest one changes.
    """

    tick: int
    fired: tuple[int, int]
    best: tuple[int, int]
    gap: float


class Compared(NamedTuple):
    """A flight of C against the reference: its requests, the ticks that differ, the least gap of all."""

    requests: int
    differences: list[Difference]
    least_gap: float


def compare(reference, vectors):
    """Each answer of golden vectors against the reference; where it is equal, so are its bytes."""
    requests, differences, least_gap, counter = 0, [], 1.0, 0
    for vector in vectors:
        expected = reference.answer(vector.incoming)
        fires = [CoilFire.decode(frame.data) for frame in vector.outgoing if frame.can_id == CoilFire.ID]
        fire = fires[0] if fires else None
        gaps = reference.gaps()
        if _pulse(fire) != _pulse(expected):
            gap = gaps.get(_pulse(fire), 1.0)
            differences.append(Difference(vector.tick, _pulse(fire), _pulse(expected), gap))
            reference.follow(fire)
        else:
            if fire is not None:
                wanted = CoilFire(*(*_values(expected), counter)).encode().data
                assert [frame.data for frame in vector.outgoing if frame.can_id == CoilFire.ID] == [wanted]
            if fire is not None or reference.view.lockout_ms == (0, 0, 0):
                least_gap = min([least_gap, *sorted(gaps.values())[1:2]])
        requests += fire is not None
        counter = counter + (fire is not None) & 0xF
    return Compared(requests, differences, least_gap)


def _pulse(fire):
    return (0, 0) if fire is None else (fire.coil, fire.level)


def _values(fire):
    return fire.level, fire.coil, fire.seq, fire.tick & 0xFF, fire.duration_ms
