"""Field tracking by direction: the field's direction is turned onto the expected one, its size left alone."""

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import ZERO, Vec3, norm, scale, sub, unit
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.field_tracking import track
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint


def direction_error(b_body_t: Vec3, expected_t: Vec3) -> Vec3:
    """|B| (b/|b| - B/|B|), T: b - B without the error in size.

    As the demand, -k1 times this, pulls b onto B, it turns the body about b x B and about no axis along the
    field, about which the air must turn it.

    Args:
        b_body_t: field in body axes.
        expected_t: B, field in orbit axes, component by component.

    Source: Psiaki 2004, as in Ovchinnikov, Roldugin 2019, section 2.4 [64]: a modification of eq. 7 that
    makes the fields in body and orbit axes coincide, one axis, while the air holds another. The scan has lost
    its equation; it is taken here as eq. 7 for directions.
    """
    return scale(norm(expected_t), sub(unit(b_body_t), unit(expected_t)))


def direction_tracking(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """The dipole m = -2 k_a e - k_w de/dt, e the direction error, from magnetometer and orbit alone."""
    sample, reference = inputs.sample, inputs.reference
    if reference is None or sample.tick < 0:
        return Demand()
    expected_t = rotate(reference.q_orbit_from_eci, reference.b_eci_t)
    if ZERO in (sample.b_body_t, expected_t):
        return Demand(memory=memory)
    return track(direction_error(sample.b_body_t, expected_t), sample.tick, memory, setpoint, config)


LAWS = {
    "direction_tracking": LawEntry(35, Aim.THREE_AXIS, direction_tracking, direction_tracking),
}
