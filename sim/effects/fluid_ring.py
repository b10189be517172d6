"""The torque of a ring of conducting fluid that a pump drives."""

from dataclasses import dataclass
from math import exp, pi

from fsw.input.quantities import quantity
from sim.plant.own_effects import Moment
from sim.plant.rotation import Vec3, cross


@dataclass(frozen=True)
class FluidRing:
    """A thin ring about body axis 1, 2 or 3, its fluid at rest until the pump begins.

    The default is a ring of gallium alloy.
    """

    axis: float = quantity(3.0, "", least=1.0, most=3.0)
    ring_radius_m: float = quantity(0.15, "m", least=1e-3, most=10.0)
    tube_radius_m: float = quantity(0.004, "m", least=1e-4, most=1.0)
    density_kgpm3: float = quantity(6440.0, "kg/m^3", least=1.0, most=2e4)
    viscosity_pas: float = quantity(2.4e-3, "Pa s", least=1e-5, most=10.0)
    pressure_pa: float = quantity(0.05, "Pa", least=-1e5, most=1e5)
    begins_s: float = quantity(0.0, "s", least=0.0)

    def __post_init__(self) -> None:
        if self.axis not in (1.0, 2.0, 3.0):
            raise ValueError(f"the ring's axis is body axis 1, 2 or 3, not {self.axis:g}")

    def torque_body_nm(self, moment: Moment) -> Vec3:
        """-dh/dt e - omega x h e, body axes, N m, e the axis and h the fluid's momentum against the body."""
        t_s = moment.t_s - self.begins_s
        if t_s < 0.0:
            return (0.0, 0.0, 0.0)
        place = int(self.axis) - 1
        along = [0.0, 0.0, 0.0]
        along[place] = self.momentum_nms(t_s)
        x, y, z = cross((along[0], along[1], along[2]), moment.omega_body_radps)
        turned = [x, y, z]
        turned[place] -= self.most_momentum_nms / self.time_s * exp(-t_s / self.time_s)
        return (turned[0], turned[1], turned[2])

    @property
    def time_s(self) -> float:
        """Tau = rho r^2 / (8 mu): of laminar flow in a tube of radius r."""
        return self.density_kgpm3 * self.tube_radius_m**2 / (8.0 * self.viscosity_pas)

    @property
    def most_momentum_nms(self) -> float:
        """H_inf = pump's torque times tau: pressure times the tube's section times the ring's radius."""
        return self.pressure_pa * pi * self.tube_radius_m**2 * self.ring_radius_m * self.time_s

    def momentum_nms(self, t_s: float) -> float:
        """H = h_inf (1 - exp(-t / tau)), from dh/dt = p A R - h / tau.

        The mean flow U obeys rho L dU/dt = p - 8 mu L U / r^2 (Poiseuille) with L = 2 pi R and
        h = rho A L R U. That the body's own acceleration drags the fluid along is left out: the fluid's
        moment of inertia is taken as small against the body's.

        Args:
            t_s: since the pump began, at a constant pressure.

        Source: Nobari, Misra 2014, as in Ovchinnikov, Roldugin 2019, section 2.4 [67], which names the rings;
        the equations are those of laminar flow.
        """
        return self.most_momentum_nms * (1.0 - exp(-t_s / self.time_s))
