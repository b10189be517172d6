"""The attitude as control and telemetry use it."""

from typing import Final, final

from fsw.core.algebra.quaternion import Quaternion
from fsw.core.algebra.vector import ZERO, Vec3
from fsw.wire.value import Value


@final
class Attitude(Value):
    """Attitude and rate of the body relative to the orbital frame, with 3 sigma of each.

    ``valid``: as certain as others may rely on; ``usable``: proven, and certain enough to be controlled by;
    by default if it is valid.
    """

    FIELDS = (
        *("q_body_from_orbit", "omega_body_orbit_radps"),
        *("sigma3_attitude_rad", "sigma3_rate_radps", "valid", "usable"),
    )
    __slots__ = FIELDS

    def __init__(
        self,
        q_body_from_orbit: Quaternion,
        omega_body_orbit_radps: Vec3,
        sigma3_attitude_rad: float,
        sigma3_rate_radps: float,
        valid: bool,
        usable: bool | None = None,
    ) -> None:
        self.q_body_from_orbit = q_body_from_orbit
        self.omega_body_orbit_radps = omega_body_orbit_radps
        self.sigma3_attitude_rad = sigma3_attitude_rad
        self.sigma3_rate_radps = sigma3_rate_radps
        self.valid = valid
        self.usable = valid if usable is None else usable

    def invalid(self) -> "Attitude":
        """The same attitude, neither valid nor usable."""
        return self._not_valid(usable=False)

    def doubted(self) -> "Attitude":
        """The same attitude, as usable as it is, but not valid."""
        return self._not_valid(usable=self.usable)

    def _not_valid(self, usable: bool) -> "Attitude":
        return Attitude(
            self.q_body_from_orbit,
            self.omega_body_orbit_radps,
            self.sigma3_attitude_rad,
            self.sigma3_rate_radps,
            False,
            usable,
        )


UNKNOWN = Attitude((1.0, 0.0, 0.0, 0.0), ZERO, 4.0, 1.0, False)

RATE_LIMIT_RADPS: Final = 0.5
"""About each axis: no satellite is to turn as fast."""


def rate_bounded(attitude: Attitude) -> bool:
    """Whether the rate is one that the satellite may have."""
    x, y, z = attitude.omega_body_orbit_radps
    return abs(x) < RATE_LIMIT_RADPS and abs(y) < RATE_LIMIT_RADPS and abs(z) < RATE_LIMIT_RADPS
