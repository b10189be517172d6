"""Gains of the PD law tuned by the linear-quadratic regulator.

The periodic regulator asks for m = K_w(u) Omega + K_a(u) theta. The PD law m = -b x (k_w Omega + 2 k_a theta)
that comes nearest to it over the orbit, by the sum of squares of the elements, has

    k_w = -sum <K_w, [b x]> / sum |[b x]|^2,     k_a = -1/2 sum <K_a, [b x]> / sum |[b x]|^2,

b the field on the nominal attitude. The effort decides how strong the gains are.

Source: Ovchinnikov, Roldugin 2019, section 3.1, after Chasset, Noteborn, Bodin, Larsson, Jakobsson 2013: the
PD law aboard TANGO, its gains by the regulator. The review does not say how they were drawn from it; the
nearest over the orbit is this project's choice.
"""

import numpy as np

from sim.design.theory.bodies import Body
from sim.design.theory.linear import Gains, dipole_field, skew
from sim.design.theory.periodic_lqr import Weights, design


def lqr_gains(body: Body, effort: float = 1.0) -> Gains:
    """The PD gains nearest to the regulator of this effort.

    Raises:
        NotConvergedError: there is no such regulator.
    """
    law = design(body, Weights(effort=effort))
    cross = body.field_t * skew(dipole_field(law.u_rad, body))
    size = float(np.sum(cross**2))
    k_w, twice_k_a = (-float(np.sum(law.gain[..., part : part + 3] * cross)) / size for part in (0, 3))
    return Gains(k_w, 0.5 * twice_k_a)
