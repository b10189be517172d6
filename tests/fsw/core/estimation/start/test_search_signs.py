"""An attitude has two quaternions: motions that differ by nothing else are one."""

from dataclasses import replace

import numpy as np
from batch_samples import CONFIG, STARTS, flight
from cell_samples import CELLS

from fsw.core.estimation.start.batch_model import model_of
from fsw.core.estimation.start.search import STEPS, Stage, start_search, work

MODEL = model_of(CONFIG, CELLS)


def test_the_same_motion_with_the_other_sign_is_no_rival():
    samples = flight(*STARTS[0], 6, coarse=True)[0]
    search = start_search(samples, MODEL)
    while search.steps < STEPS or search.at < len(samples) - 1:
        work(search, samples, None, MODEL)
    signs = np.where(np.arange(len(search.motions.q)) % 2, 1.0, -1.0)[:, None]
    search.best = replace(search.best, ends=signs * search.best.ends)
    search.q = np.concatenate((signs * search.q[: len(signs)], search.q[len(signs) :]))
    work(search, samples, None, MODEL)
    assert search.stage is Stage.CARRY
