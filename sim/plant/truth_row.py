"""The plant's truth at one instant."""

from typing import final

from fsw.wire.value import Value
from sim.plant.rotation import Quaternion, Vec3


@final
class TruthRow(Value):
    """The truth at a sampled instant t_k.

    Args:
        t_s: time since tick 0.
        q_body_from_orbit: attitude, scalar part >= 0.
        omega_body_orbit_radps: rate relative to the orbital frame, body axes.
        b_body_t: field, body axes.
        sun_body: unit vector from the satellite to the Sun.
        lit: visible fraction of the Sun's disc.
        m_body_am2: mean true dipole of the coils over the tick that ends at t_k.
        r_eci_m: position.
        torque_body_nm: at t_k, by ``Plant.torque_sources``; the coils' is m x b of this row, those of noise
            and wheel acted until t_k.
        wheel_nms: momentum of a driven wheel relative to the body, along its axis; None: there is none.
    """

    FIELDS = (
        "t_s",
        "q_body_from_orbit",
        "omega_body_orbit_radps",
        "b_body_t",
        "sun_body",
        "lit",
        "m_body_am2",
        "r_eci_m",
        "torque_body_nm",
        "wheel_nms",
    )
    __slots__ = FIELDS

    def __init__(
        self,
        t_s: float,
        q_body_from_orbit: Quaternion,
        omega_body_orbit_radps: Vec3,
        b_body_t: Vec3,
        sun_body: Vec3,
        lit: float,
        m_body_am2: Vec3,
        r_eci_m: Vec3,
        torque_body_nm: tuple[Vec3, ...],
        wheel_nms: float | None = None,
    ) -> None:
        self.t_s = t_s
        self.q_body_from_orbit = q_body_from_orbit
        self.omega_body_orbit_radps = omega_body_orbit_radps
        self.b_body_t = b_body_t
        self.sun_body = sun_body
        self.lit = lit
        self.m_body_am2 = m_body_am2
        self.r_eci_m = r_eci_m
        self.torque_body_nm = torque_body_nm
        self.wheel_nms = wheel_nms

    def numbers(self) -> list[float]:
        """All numbers in the order of the attributes; without the wheel's, if there is none."""
        qw, qx, qy, qz = self.q_body_from_orbit
        wx, wy, wz = self.omega_body_orbit_radps
        bx, by, bz = self.b_body_t
        sx, sy, sz = self.sun_body
        mx, my, mz = self.m_body_am2
        rx, ry, rz = self.r_eci_m
        row = [self.t_s, qw, qx, qy, qz, wx, wy, wz, bx, by, bz, sx, sy, sz, self.lit, mx, my, mz, rx, ry, rz]
        for torque_body_nm in self.torque_body_nm:
            row.extend(torque_body_nm)
        if self.wheel_nms is not None:
            row.append(self.wheel_nms)
        return row
