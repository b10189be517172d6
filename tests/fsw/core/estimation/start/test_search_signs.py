"""An attitude has two quaternions: motions that differ by nothing else are one."""

import numpy as np
from batch_samples import CONFIG, STARTS, flight
from cell_samples import CELLS

from fsw.core.estimation.start.batch_model import model_of
from fsw.core.estimation.start.search import STEPS, MotionSearch, Stage, begun, worked

MODEL = model_of(CONFIG, CELLS)


def test_the_same_motion_with_the_other_sign_is_no_rival():
    samples = flight(*STARTS[0], 6, coarse=True)[0]
    search = begun(samples, MODEL)
    while search.steps < STEPS or search.at < len(samples) - 1:
        search = worked(search, samples, None, MODEL)
    signs = np.where(np.arange(len(search.motions.q)) % 2, 1.0, -1.0)[:, None]
    best = search.best._replace(ends=signs * search.best.ends)
    q = np.concatenate((signs * search.q[: len(signs)], search.q[len(signs) :]))
    found = worked(search._replace(q=q, best=best), samples, None, MODEL)
    assert isinstance(found, MotionSearch)
    assert found.stage is Stage.CARRY
