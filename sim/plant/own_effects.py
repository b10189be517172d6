"""The user's own effects on the satellite: a torque on the body, an error of a sensor.

An effect is a frozen dataclass whose fields are its parameters (``fsw.input.quantities.quantity`` gives them
units and ranges), with any of the methods of ``ACTIONS``. It sees the instant of a tick; its torque lasts
until the next tick.
"""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any, Final, final

from fsw.wire.value import Value
from sim.plant.errors import PlantError
from sim.plant.interference import Interference
from sim.plant.rotation import ZERO, Quaternion, Vec3

ACTIONS = ("torque_body_nm", "field_body_t", "sun_body")
"""What an effect may have: ``torque_body_nm(moment)`` [N m], and ``field_body_t(b_body_t, moment)`` [T] and
``sun_body(sun_body, moment)``, which replace what magnetometer and Sun sensor give."""


@final
class Moment(Value):
    """What an effect sees of the instant of a tick; directions are unit vectors, ``eci`` is TEME of date.

    Args:
        t_s: since tick 0.
        q_body_from_eci: attitude.
        omega_body_radps: inertial rate.
        b_body_t: field.
        sun_body: from the satellite to the Sun.
        lit: visible fraction of the Sun's disc.
        r_eci_m: position.
        v_eci_mps: velocity.
    """

    FIELDS = (
        "t_s",
        "q_body_from_eci",
        "omega_body_radps",
        "b_body_t",
        "sun_body",
        "lit",
        "r_eci_m",
        "v_eci_mps",
    )
    __slots__ = FIELDS

    def __init__(
        self,
        t_s: float = 0.0,
        q_body_from_eci: Quaternion = (1.0, 0.0, 0.0, 0.0),
        omega_body_radps: Vec3 = ZERO,
        b_body_t: Vec3 = ZERO,
        sun_body: Vec3 = ZERO,
        lit: float = 1.0,
        r_eci_m: Vec3 = ZERO,
        v_eci_mps: Vec3 = ZERO,
    ) -> None:
        self.t_s = t_s
        self.q_body_from_eci = q_body_from_eci
        self.omega_body_radps = omega_body_radps
        self.b_body_t = b_body_t
        self.sun_body = sun_body
        self.lit = lit
        self.r_eci_m = r_eci_m
        self.v_eci_mps = v_eci_mps


@final
class OwnEffect:
    """An effect; the histories call its torque ``source``, messages call it ``name``."""

    __slots__ = ("effect", "name", "source")

    def __init__(self, source: str, name: str, effect: object) -> None:
        self.source = source
        self.name = name
        self.effect = effect

    def action(self, name: str) -> Callable[..., Any] | None:
        """What it does under one of ``ACTIONS``, if anything."""
        found: Callable[..., Any] | None = getattr(self.effect, name, None)
        return found


@final
class OwnEffects(Interference):
    """All effects of a plant, in their order."""

    def __init__(self, effects: Sequence[OwnEffect] = ()) -> None:
        self._by_action = {
            action: [(one.name, act) for one in effects if (act := one.action(action)) is not None]
            for action in ACTIONS
        }
        self.torque_sources = tuple(one.source for one in effects if one.action("torque_body_nm") is not None)
        self.torques_body_nm: tuple[Vec3, ...] = ()
        """The torques from the last observed moment on."""
        self._moment = Moment()
        self.any = bool(effects)

    def observe(self, moment: Moment) -> None:
        """A tick begins.

        Raises:
            PlantError: an effect fails, or its torque is not a finite vector.
        """
        self._moment = moment
        self.torques_body_nm = tuple(
            self._vector(name, act, moment) for name, act in self._by_action["torque_body_nm"]
        )

    def field(self, b_body_t: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The magnetometer's reading [T] after all effects on it."""
        for name, act in self._by_action["field_body_t"]:
            b_body_t = self._vector(name, act, b_body_t, self._moment)
        return b_body_t, valid

    def sun(self, sun_body: Vec3, valid: bool) -> tuple[Vec3, bool]:
        """The Sun sensor's reading after all effects on it; they do not act where it sees no Sun."""
        for name, act in self._by_action["sun_body"] if valid else ():
            sun_body = self._vector(name, act, sun_body, self._moment)
        return sun_body, valid

    def _vector(self, name: str, act: Callable[..., Any], *arguments: object) -> Vec3:
        where = f"the effect {name}, {self._moment.t_s:g} s"
        try:
            x, y, z = map(float, act(*arguments))
        except (Exception, SystemExit) as error:
            text = f"{type(error).__name__}: {error}"[:300]
            raise PlantError(f"{where}: it fails: {text}") from None
        if not isfinite(x + y + z):
            raise PlantError(f"{where}: it gives {x:g}, {y:g}, {z:g}, which is not finite")
        return (x, y, z)


NO_EFFECTS: Final = OwnEffects()
