"""The plant's truth at one instant."""

from typing import NamedTuple

from sim.plant.rotation import Quaternion, Vec3


class TruthRow(NamedTuple):
    """The truth at a sampled instant t_k."""

    t_s: float
    q_body_from_orbit: Quaternion
    """Scalar part >= 0."""
    omega_body_orbit_radps: Vec3
    b_body_t: Vec3
    sun_body: Vec3
    """Unit vector from the satellite to the Sun."""
    lit: float
    """Visible fraction of the Sun's disc."""
    m_body_am2: Vec3
    """Mean true dipole of the coils over the tick that ends at t_k."""
    r_eci_m: Vec3
    torque_body_nm: tuple[Vec3, ...]
    """At t_k, by ``Plant.torque_sources``; the coils' is m x b of this row, those of noise and wheel
    acted until t_k."""
    wheel_nms: float | None = None
    """Momentum of a driven wheel relative to the body, along its axis; None: there is none."""
