"""Three coils: current, dipole, remanence and read-back."""

from math import exp, expm1, prod
from typing import final

from sim.plant.config import CoilConfig
from sim.plant.rotation import ZERO, Mat3, Vec3, from_vector, matrix, transform
from sim.plant.sensor_config import AS_NAMED, Wiring

# --- The dipoles that the cores of the coils keep after a pulse


@final
class Remanence:
    """Coil j keeps m_j = part m_pulse,j, m_pulse,j the dipole of its last pulse, until its next one.

    A model of a core that each pulse drives far beyond its coercive field, without a hysteresis loop: while
    it is driven its dipole is that of the current, whatever it kept before, and then a part remains. Dipoles
    are stated as the currents that would cause them, so that a coil's gain and axis apply to both.

    Args:
        part: fraction of the dipole of a pulse that is kept.
    """

    def __init__(self, part: float) -> None:
        self.part = part
        self._kept_a = ZERO
        self.now_a = ZERO
        """At the end of the last step."""
        self.mean_a = ZERO
        """Mean over the last step."""

    def advance(self, driven_a: Vec3, on_s: float, step_s: float, held_a: Vec3 = ZERO) -> None:
        """Advance by a step in which coils are driven from its start for ``on_s``.

        Args:
            driven_a: current that each coil is driven to, 0 for none.
            on_s: how long, 0 to ``step_s``.
            step_s: length of the step.
            held_a: current that each coil is driven to for the rest of it, 0 for none.
        """
        if not on_s and held_a == ZERO:
            self.now_a = self.mean_a = self._kept_a
            return
        x, y, z = self._kept_a
        off = 1.0 - on_s / step_s
        x, p = self._after(driven_a[0], held_a[0], x, on_s, off)
        y, q = self._after(driven_a[1], held_a[1], y, on_s, off)
        z, r = self._after(driven_a[2], held_a[2], z, on_s, off)
        self._kept_a = (x, y, z)
        self.mean_a = (x * p, y * q, z * r)
        self.now_a = (x if p else x * p, y if q else y * q, z if r else z * r)

    def _after(
        self, driven_a: float, held_a: float, kept_a: float, on_s: float, off_part: float
    ) -> tuple[float, float]:
        """What a coil keeps after a step, and the part of the step in which it acts."""
        if held_a:
            return self.part * held_a, 0.0
        if driven_a and on_s:
            return self.part * driven_a, off_part
        return kept_a, 1.0


# --- The coils

_EXTINCT_A = 1e-15
"""A current below this counts as zero."""


@final
class Coils:
    """Currents that follow their targets with a first-order lag: di/dt = (i_driven - i) / tau.

    Their dipole is m = sum of k_j i_j R(turn_j) e(j), k_j the true dipole of one ampere, e(j) by ``wiring``.

    Args:
        config: the coils.
    """

    def __init__(self, config: CoilConfig) -> None:
        self._config = config
        self._tau_s = config.time_constant_s
        self._dipole_per_ampere = [config.dipole_per_ampere_am2 * scale for scale in config.dipole_scale]
        self._body_from_coils = body_from_coils(config.misalignment_rad, config.wiring)
        self._scales: list[list[float]] = [[], [], []]
        self._remanence = Remanence(config.remanence_part)
        self._current_a = ZERO

    def rescale(self, coil: int, scale: float) -> None:
        """Scale the dipole of a coil from now on, in addition to the scales that it has."""
        self._scales[coil].append(scale)
        self._apply_scales(coil)

    def restore(self, coil: int, scale: float) -> None:
        """Take back one of these scales; the others stay."""
        self._scales[coil].remove(scale)
        self._apply_scales(coil)

    def _apply_scales(self, coil: int) -> None:
        config = self._config
        nominal = config.dipole_per_ampere_am2 * config.dipole_scale[coil]
        self._dipole_per_ampere[coil] = nominal * prod(self._scales[coil])

    @property
    def dipole_body_am2(self) -> Vec3:
        """The dipole at this instant: of the currents, and what the cores keep."""
        (x, y, z), (kx, ky, kz) = self._current_a, self._remanence.now_a
        return self._dipole((x + kx, y + ky, z + kz))

    @property
    def remanence_body_am2(self) -> Vec3:
        """The dipole that the cores keep at this instant."""
        return self._dipole(self._remanence.now_a)

    @property
    def mean_remanence_body_am2(self) -> Vec3:
        """The mean of what the cores kept over the last step."""
        return self._dipole(self._remanence.mean_a)

    @property
    def readback_a(self) -> float:
        """The current at this instant in the supply that all coils share, signed like the level."""
        x, y, z = self._current_a
        return x + y + z

    def advance(self, driven_a: Vec3, on_s: float, step_s: float, held_a: Vec3 = ZERO) -> Vec3:
        """Advance by a step in which coils are driven from its start for ``on_s``; exact mean dipole [A m^2].

        The mean, not the end value, carries the impulse: the lag is far shorter than a step.

        Args:
            driven_a: current that each coil is driven to, 0 for none.
            on_s: how long, 0 to ``step_s``.
            step_s: length of the step.
            held_a: current that each coil is driven to for the rest of it.
        """
        if self._remanence.part:
            self._remanence.advance(driven_a, on_s, step_s, held_a)
        if self._current_a == ZERO and (not on_s or driven_a == ZERO) and held_a == ZERO:
            return ZERO
        i, j, k = self._current_a
        x, i = self._mean_current(i, driven_a[0], on_s, step_s, held_a[0])
        y, j = self._mean_current(j, driven_a[1], on_s, step_s, held_a[1])
        z, k = self._mean_current(k, driven_a[2], on_s, step_s, held_a[2])
        self._current_a = (i, j, k)
        return self._dipole((x, y, z))

    def _dipole(self, current_a: Vec3) -> Vec3:
        if current_a == ZERO:
            return ZERO
        i, j, k = current_a
        full = self._dipole_per_ampere
        by_coil = (full[0] * i, full[1] * j, full[2] * k)
        axes = self._body_from_coils
        return by_coil if axes is None else transform(axes, by_coil)

    def _mean_current(
        self, start_a: float, target_a: float, on_s: float, step_s: float, held_a: float
    ) -> tuple[float, float]:
        """Of one coil over a step, and its current at the end."""
        charge_on, turned_off_a = self._follow(start_a, target_a, on_s)
        charge_off, end_a = self._follow(turned_off_a, held_a, step_s - on_s)
        mean_a = (charge_on + charge_off) / step_s
        return mean_a, end_a if abs(end_a) > _EXTINCT_A else 0.0

    def _follow(self, start_a: float, target_a: float, time_s: float) -> tuple[float, float]:
        """Integral [A s] and end value [A] of i(t) = target + (start - target) exp(-t / tau)."""
        if time_s <= 0.0:
            return 0.0, start_a
        if self._tau_s == 0.0:
            return target_a * time_s, target_a
        gap_a, x = start_a - target_a, time_s / self._tau_s
        return target_a * time_s - gap_a * self._tau_s * expm1(-x), target_a + gap_a * exp(-x)


def body_from_coils(turns_rad: Mat3, wiring: Wiring) -> Mat3 | None:
    """The matrix whose columns are the coils' axes, in body axes; None where they are the body axes."""
    if turns_rad == (ZERO, ZERO, ZERO) and wiring == AS_NAMED:
        return None
    # C(q) takes body axes to the turned ones: its row j is the turned axis j
    turned = [matrix(from_vector(turn))[abs(axis) - 1] for turn, axis in zip(turns_rad, wiring, strict=True)]
    a, b, c = (
        row if axis > 0 else (-row[0], -row[1], -row[2]) for row, axis in zip(turned, wiring, strict=True)
    )
    return ((a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2]))
