"""The law of each mode."""

from fsw.core.algebra.vector import sub
from fsw.core.estimation.attitude import rate_bounded
from fsw.core.laws.damping import bdot, rate_damping
from fsw.core.laws.entry import LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, FieldSample, LawInput, Memory, OwnLaw, Setpoint
from fsw.core.laws.plan.law_axes import LawAxes
from fsw.core.laws.plan.pulse_model import Pulse
from fsw.core.laws.predictive import predictive
from fsw.core.laws.table import LAWS, open_loop
from fsw.wire.messages import Mode


def detumble(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """By the estimated rate if it is usable: predictive with pulses, proportional without. Otherwise B-dot.

    B-dot too where the estimate is beyond what the monitor allows: it may be wrong.
    """
    if not inputs.attitude.usable or not rate_bounded(inputs.attitude):
        return bdot(inputs, memory, setpoint, config)
    law = predictive if config.pulsed else rate_damping
    return law(inputs, memory, setpoint, config)


def demand(
    mode: Mode, inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig
) -> Demand | None:
    """The demand of the law of this mode, body axes; None in SAFE. The residual dipole is subtracted.

    In DETUMBLE it is that of ``detumble``, unchanged, unless the law is ``open_loop``. Inputs are in body
    axes; the law sees them, and answers, in its own.
    """
    axes = config.axes
    if axes is None:
        return _demand(mode, inputs, memory, setpoint, config)
    wanted = _demand(mode, law_input(inputs, axes), memory, setpoint, config)
    return None if wanted is None else demand_of_body(wanted, axes)


def law_input(of_body: LawInput, axes: LawAxes) -> LawInput:
    """What a law receives, in its axes."""
    a, b, c = axes.place
    waits = of_body.wait_ticks
    return LawInput(
        axes.attitude(of_body.attitude),
        axes.of_body(of_body.b_body_t),
        FieldSample(axes.of_body(of_body.sample.b_body_t), of_body.sample.tick),
        FieldSample(axes.of_body(of_body.before.b_body_t), of_body.before.tick),
        None if of_body.sun_body is None else axes.of_body(of_body.sun_body),
        of_body.reference,
        axes.of_body(of_body.torque_body_nm),
        axes.of_body(of_body.dipole_body_am2),
        of_body.tick,
        of_body.ephemeris,
        (waits[a], waits[b], waits[c]),
        of_body.wheel_nms,
    )


def demand_of_body(of_law: Demand, axes: LawAxes) -> Demand:
    """What a law demands, in body axes; its memory is its own."""
    impulse, pulse = of_law.impulse_body_nms, of_law.pulse
    return Demand(
        axes.to_body(of_law.m_body_am2),
        None if impulse is None else axes.to_body(impulse),
        of_law.memory,
        None if pulse is None else Pulse(axes.place[pulse.coil], axes.sign[pulse.coil] * pulse.level),
        of_law.wheel_torque_nm,
    )


def _demand(
    mode: Mode, inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig
) -> Demand | None:
    match mode:
        case Mode.SAFE:
            return None
        case Mode.DETUMBLE if not open_loop(setpoint):
            return detumble(inputs, memory, setpoint, config).without_memory()
        case Mode.ACQUIRE | Mode.DETUMBLE:
            return _net(_forms(setpoint, config).acquire(inputs, memory, setpoint, config), inputs)
        case Mode.POINT:
            return _net(_forms(setpoint, config).point(inputs, memory, setpoint, config), inputs)


def _forms(setpoint: Setpoint, config: ControlConfig) -> LawEntry | OwnLaw:
    """The law of the setpoint."""
    own = config.own
    return own if own is not None and own.name == setpoint.law else LAWS[setpoint.law]


def _net(wanted: Demand, inputs: LawInput) -> Demand:
    """The dipole wanted, less the residual dipole, which turns the satellite as the coils do.

    So too where a law wants none for lack of what it needs: nothing is gained by leaving the residual dipole
    to act.
    """
    if wanted.impulse_body_nms is not None or wanted.pulse is not None or not inputs.attitude.usable:
        return wanted
    m_body_am2 = sub(wanted.m_body_am2, inputs.dipole_body_am2)
    return Demand(m_body_am2, memory=wanted.memory, wheel_torque_nm=wanted.wheel_torque_nm)
