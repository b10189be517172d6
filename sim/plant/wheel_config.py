"""The configuration of a reaction wheel that is driven."""

from dataclasses import dataclass
from math import isclose

from sim.plant.rotation import Mat3, Vec3


@dataclass(frozen=True, slots=True)
class WheelConfig:
    """A wheel with its motor, as it is.

    Attributes:
        axis_body: unit vector along its axis, body axes.
        inertia_kgm2: of the wheel about its axis; the body's inertia includes it.
        max_torque_nm: of the motor.
        max_momentum_nms: relative to the body, beyond which the motor cannot speed it up.
        viscous_nms: c of the friction c W, W its speed relative to the body.
        coulomb_nm: of the friction that is nearly constant, against the direction of W.
        time_constant_s: with which the motor torque follows the request, 0 for at once.
        torque_scale: true over requested motor torque.
        momentum_nms: relative to the body, at the epoch.

    Raises:
        ValueError: a quantity is out of range.
    """

    axis_body: Vec3
    inertia_kgm2: float
    max_torque_nm: float
    max_momentum_nms: float
    viscous_nms: float = 0.0
    coulomb_nm: float = 0.0
    time_constant_s: float = 0.0
    torque_scale: float = 1.0
    momentum_nms: float = 0.0

    def __post_init__(self) -> None:
        if not isclose(sum(part * part for part in self.axis_body), 1.0, abs_tol=1e-9):
            raise ValueError("axis_body is not of unit length")
        for name in ("inertia_kgm2", "max_torque_nm", "max_momentum_nms"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive")
        for name in ("viscous_nms", "coulomb_nm", "time_constant_s"):
            if not getattr(self, name) >= 0.0:
                raise ValueError(f"{name} must not be negative")
        if not abs(self.momentum_nms) <= self.max_momentum_nms:
            raise ValueError("momentum_nms must not be above max_momentum_nms")

    def rest_of(self, inertia_kgm2: Mat3) -> Mat3:
        """J - J_w w w^T: what of the whole satellite's inertia J turns with the body about every axis."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia_kgm2
        (x, y, z), own = self.axis_body, self.inertia_kgm2
        xx, yy, zz = xx - own * x * x, yy - own * y * y, zz - own * z * z
        xy, xz, yz = xy - own * x * y, xz - own * x * z, yz - own * y * z
        return ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
