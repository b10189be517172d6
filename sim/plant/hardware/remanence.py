"""The dipoles that the cores of the coils keep after a pulse."""

from typing import final

from sim.plant.rotation import ZERO, Vec3


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
