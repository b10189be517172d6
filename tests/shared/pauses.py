"""Tests in real time on a machine that may stand still: a run that it has disturbed is made again.

What fails by a fault of the code fails in each run, and only after a pause of the machine is there another.
"""

from sim.conformance.command import MOST_PAUSE_S
from sim.conformance.pauses import PauseWatch

RUNS = 3


def run_undisturbed(run, is_as_expected):
    """The result of ``run()``: the first as expected or without a pause of the machine, or the last."""
    for _ in range(RUNS):
        with PauseWatch() as watch:
            result = run()
        longest_s = watch.take_longest_s()
        print(f"as expected: {is_as_expected(result)}, longest pause {longest_s:.3f} s")
        if is_as_expected(result) or longest_s <= MOST_PAUSE_S:
            break
    return result
