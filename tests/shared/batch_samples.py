"""What the tests of the start from Sun cells use: flights of which a batch is taken, and their filter."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
from cell_samples import CELLS, REFERENCE, cell_filter

from fsw.core.algebra.quaternion import normalise
from fsw.core.algebra.vector import ZERO
from fsw.core.estimation.cells.cell_set import light
from fsw.core.estimation.cells.coarse_sun import coarse_sun
from fsw.core.estimation.parameters import Prior
from fsw.core.estimation.start.batch import SPACING_S, SampleBatch
from fsw.core.estimation.start.batch_model import model_of
from fsw.core.estimation.start.batch_sample import UNKNOWN, BatchSample
from fsw.core.estimation.start.motions import Disturbed, Leg, flown, in_body
from fsw.core.estimation.start.search import start_search, work
from fsw.core.orbit.earth import MU_M3PS2

MOVING_PRIORS = {
    "torque_body_nm": Prior((3e-8,) * 3, (0.0,) * 3),
    "dipole_body_am2": Prior((0.01,) * 3, (0.0,) * 3),
    "inertia_error_kgm2": Prior((0.03, 0.05, 0.04, 0.01, 0.01, 0.01), (0.0,) * 6),
}
CONFIG = cell_filter(**MOVING_PRIORS)
EXCESS = np.array((0.05, -0.06, 0.04, -0.05, 0.06, 0.03))
BIAS_T = np.array((2e-7, -3e-7, 2.5e-7))


def flight(q, omega, count, *, unused=(), seed=1, coarse=False, driven_am2=ZERO):
    """Samples of a flight, one in 20 s, with excess, bias and noise, and attitude and rate at its end."""
    random = np.random.default_rng(seed)
    q, omega = np.array([q]), np.array([omega])
    rotor = CONFIG.rotor
    disturbed = Disturbed(np.full((1, 3), 0.004), np.full((1, 3), 1e-8), np.full((1, 6), 0.004))
    samples = []
    along = np.cross(REFERENCE.r_eci_m, (0.3, 0.2, 0.9))
    along *= REFERENCE.radius_m / np.linalg.norm(along)
    normals = np.array(CELLS.normals_body)
    s = np.array(REFERENCE.sun_eci)
    for number in range(count):
        angle = 1.04e-3 * SPACING_S * number
        r = np.cos(angle) * np.array(REFERENCE.r_eci_m) + np.sin(angle) * along
        b = np.array(REFERENCE.b_eci_t) + 2e-5 * angle * np.array((0.5, 1.2, -0.8))
        earth = light(tuple(r.tolist()), REFERENCE.sun_eci, CELLS.albedo).earth
        shine = np.maximum(0.0, in_body(q, s)[0] @ normals.T)
        shine += earth * (0.5 + 0.5 * in_body(q, -r / REFERENCE.radius_m)[0] @ normals.T) ** 2
        shown = shine + EXCESS * (shine > 0.1) + 0.01 * random.normal(size=6)
        currents = tuple(
            UNKNOWN if cell in unused else max(0.0, float(one)) for cell, one in enumerate(shown)
        )
        field = in_body(q, b)[0] + BIAS_T + 2e-7 * random.normal(size=3)
        sun = coarse_sun(currents, CELLS) if coarse else None
        since = SPACING_S if number else 0.0
        samples.append(
            BatchSample(
                since,
                driven_am2 if number else ZERO,
                tuple(field.tolist()),
                currents,
                tuple(b.tolist()),
                REFERENCE.sun_eci,
                tuple(r.tolist()),
                1.0,
                earth,
                sun,
            )
        )
        if number < count - 1:
            step = 1.04e-3 * SPACING_S
            middle = np.cos(angle + step / 2) * np.array(REFERENCE.r_eci_m) + np.sin(angle + step / 2) * along
            gravity = 3.0 * MU_M3PS2 / REFERENCE.radius_m**3
            after = Leg(SPACING_S, middle / REFERENCE.radius_m, b, gravity, np.array(driven_am2))
            q, omega = flown(q, omega, after, disturbed, rotor)
    return tuple(samples), q[0], omega[0]


STARTS = [
    (normalise((0.6, 0.4, -0.5, -0.3)), (0.002, -0.003, 0.0015)),
    (normalise((0.1, -0.7, 0.2, 0.6)), (-0.004, 0.001, 0.003)),
    (normalise((-0.5, 0.3, 0.7, 0.2)), (0.0, 0.0, 0.0)),
]
"""Attitude and rate at the first sample."""


def search_under_way():
    """A batch of samples with three lit cells, whose search has improved its motions once; of one of them."""
    samples, _, _ = flight(*STARTS[0], 6, coarse=True)
    model = model_of(CONFIG, CELLS)
    search = start_search(samples, model)
    while search.steps < 1:
        work(search, samples, None, model)
    return SampleBatch(samples, 3.0, (0.1, -0.2, 0.3), 20.0, first_rows(search))


def first_rows(value):
    """The first row of every array."""
    if is_dataclass(value):
        parts = {field.name: first_rows(getattr(value, field.name)) for field in fields(value)}
        return replace(value, **parts)
    return value[:1] if isinstance(value, np.ndarray) else value
