"""A direction of the body held to the field, by the magnetometer alone.

With n = b / |b| and t the direction in body axes that is to lie along the field, the error is e = t - n. The
shortest turn of t onto n is about t x n = e x n, and dn/dt = n x omega in a field that does not turn, so that

    M_ref = |b|^2 (2 k_a e + k_w de/dt) x n,     m = b x M_ref / |b|^2,

de/dt by the difference of two samples: a spring and a damper. With a ``target`` the body axis t follows the
field as a bar magnet would, for any body. Without one t is the direction of the field expected in the nominal
attitude, and on average the whole attitude follows, under the conditions of ``field_tracking``; as e has
directions alone, an error in the size of the modelled or the measured field does not matter.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Gulmammadov, Kahraman, Yavuzyilmaz, Tufekci, Subasi
2010, and with a target Smirnov 2001. The scan has lost the torque but not e; the torque is derived here.
"""

from dataclasses import dataclass

from fsw.core.algebra.quaternion import rotate
from fsw.core.algebra.vector import Vec3, add, cross, dot, norm, scale, sub, unit
from fsw.core.laws.damping import MAX_DIFFERENCE_S
from fsw.core.laws.entry import Aim, LawEntry
from fsw.core.laws.interface import ControlConfig, Demand, LawInput, Memory, Setpoint
from fsw.core.laws.projection import torque_dipole


@dataclass(frozen=True, slots=True)
class FieldDirectionGains:
    """The target in body axes, of any length; where it is zero, the field of the nominal attitude."""

    target_1: float = 0.0
    target_2: float = 0.0
    target_3: float = 0.0


def direction_torque(b_body_t: Vec3, error: Vec3, error_rate_ps: Vec3, k_w: float, k_a: float) -> Vec3:
    """M_ref = |b|^2 (2 k_a e + k_w de/dt) x n, body axes, N m.

    Args:
        b_body_t: field in body axes, T, not zero.
        error: e = t - n.
        error_rate_ps: de/dt, 1/s.
        k_w: N m s / T^2.
        k_a: N m / T^2.
    """
    wanted = add(scale(2.0 * k_a, error), scale(k_w, error_rate_ps))
    return scale(norm(b_body_t), cross(wanted, b_body_t))


def field_direction(inputs: LawInput, memory: Memory, setpoint: Setpoint, config: ControlConfig) -> Demand:
    """By the magnetometer, and the orbit where there is no target; memory: tick of the last sample, its e."""
    sample, target = inputs.sample, _target(inputs, config)
    if target is None or sample.tick < 0 or dot(sample.b_body_t, sample.b_body_t) <= 0.0:
        return Demand()
    if memory and sample.tick == memory[0]:
        return Demand(memory=memory)
    error = sub(target, unit(sample.b_body_t))
    seen = (float(sample.tick), *error)
    interval_s = (sample.tick - memory[0]) * config.tick_s if memory else 0.0
    if not 0.0 < interval_s <= MAX_DIFFERENCE_S:
        return Demand(memory=seen)
    rate_ps = scale(1.0 / interval_s, sub(error, (memory[1], memory[2], memory[3])))
    torque = direction_torque(sample.b_body_t, error, rate_ps, setpoint.k_w, setpoint.k_a)
    return Demand(torque_dipole(torque, sample.b_body_t), memory=seen)


def _target(inputs: LawInput, config: ControlConfig) -> Vec3 | None:
    """The direction t; None where it would be the model's and there is none."""
    gains: FieldDirectionGains = config.gains["field_direction"]
    own = (gains.target_1, gains.target_2, gains.target_3)
    if any(own):
        return unit(own)
    reference = inputs.reference
    if reference is None or dot(reference.b_eci_t, reference.b_eci_t) <= 0.0:
        return None
    return unit(rotate(reference.q_orbit_from_eci, reference.b_eci_t))


LAWS = {
    "field_direction": LawEntry(54, Aim.THREE_AXIS, field_direction, field_direction, FieldDirectionGains),
}
