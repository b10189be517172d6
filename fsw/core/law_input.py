"""What a law is given in one tick, gathered from the state and what the tick shows of the satellite."""

from fsw.core.actuation.actuator import wait_ticks
from fsw.core.actuation.pulses import PulseConfig
from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, add
from fsw.core.estimation.parameters import NOTHING, UNCHANGED_INERTIA, Parameters, inertia_error
from fsw.core.estimation.samples import usable_field, usable_sun
from fsw.core.gate.readings import Readings
from fsw.core.laws.interface import FieldSample, LawInput
from fsw.core.laws.riccati import resting_torque
from fsw.core.orbit.ephemeris import EphemerisModel, Reference
from fsw.core.state import FlightState


def gather(
    state: FlightState,
    readings: Readings,
    reference: Reference | None,
    model: EphemerisModel,
    config: PulseConfig,
) -> LawInput:
    """The field is the modelled one where the attitude is valid, else the last one measured.

    Args:
        state: of this tick, its attitude judged.
        readings: of this tick, those that may be trusted.
        reference: orbit, field and Sun as modelled; None without an orbit.
        model: for later times.
        config: of the coils.
    """
    attitude, usable = state.attitude, usable_field(readings)
    sample = FieldSample(usable, state.tick) if usable is not None else state.sample
    b_body_t = sample.b_body_t
    if attitude.valid and reference is not None:
        b_orbit_t = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
        b_body_t = rotate(attitude.q_body_from_orbit, b_orbit_t)
    estimate = state.estimator.estimate
    parameters = estimate.parameters if estimate is not None else NOTHING
    return LawInput(
        attitude,
        b_body_t,
        sample,
        state.sample,
        usable_sun(readings),
        reference,
        _constant_torque(parameters, reference),
        parameters.dipole_body_am2,
        state.tick,
        model,
        wait_ticks(state.pulses, state.coil, readings, state.tick, config, state.health.coils.faults),
    )


def _constant_torque(parameters: Parameters, reference: Reference | None) -> Vec3:
    """On the nominal attitude: the estimated torque, and that of the inertia that the table does not know."""
    if reference is None or parameters.inertia_error_kgm2 == UNCHANGED_INERTIA:
        return parameters.torque_body_nm
    resting = resting_torque(inertia_error(parameters), ZERO, reference.orbit_rate_radps)
    return add(parameters.torque_body_nm, resting)
