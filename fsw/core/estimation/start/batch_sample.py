"""One sample of a batch: field and cells of a tick, and what was driven since the sample before."""

from dataclasses import dataclass
from typing import final

from fsw.core.algebra.vector import Vec3

UNKNOWN = -1.0
"""The current of a cell that is not to be used."""


@final
@dataclass(frozen=True, slots=True)
class BatchSample:
    """What was measured and modelled in one tick, and what was driven since the sample before.

    ``field_t`` in body axes; ``currents`` as fractions of full sunlight; ``lit``: 0 in the shadow, where the
    Sun is not seen; ``earth``: the Earth's light, as in ``Light``; ``coarse``: the Sun from three lit cells.
    """

    since_s: float
    m_body_am2: Vec3
    field_t: Vec3
    currents: tuple[float, ...]
    b_eci_t: Vec3
    s_eci: Vec3
    r_eci_m: Vec3
    lit: float
    earth: float
    coarse: Vec3 | None = None
