"""The real board process keeps invariant I under attack in real time, judged by what it logs of its pins.

Some seconds as a rule; ``make attack`` takes ten minutes. Beside what is done to a board on the bus, the
process is killed and started anew, and stopped in the middle of a pulse.
"""

import os
import sys
from random import Random

import pytest
from coil_attack import Judge, Setup
from process_target import ProcessTarget, attack_in_real_time

SECONDS = float(os.environ.get("TORQUER_ATTACK_SECONDS", "3"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))


def stub(setup, spec):
    """The words that start the stub."""
    words = {
        "--bus": spec,
        "--tick-hz": setup.tick_hz,
        "--pulse-s": setup.pulse_ms / 1000.0,
        "--backoff-s": setup.backoff_ms / 1000.0,
        "--backoff": "shared" if setup.shared else "per_coil",
        "--deadman-s": setup.deadman_ms / 1000.0,
        "--pins": "-",
    }
    return [sys.executable, "-m", "hil_stub", "coil", *(str(w) for pair in words.items() for w in pair)]


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("shared", [True, False], ids=["shared", "per coil"])
def test_no_attack_on_the_process_breaks_a_limit(shared):
    setup = Setup(10, 300, 2000, shared, 500)
    judge = Judge(setup)
    random = Random(f"{SEED}/{shared}")
    target = ProcessTarget(lambda spec: stub(setup, spec), judge, random)
    attacker = attack_in_real_time(target, setup, judge, random, SECONDS / 2)
    print(
        f"\n{SECONDS / 2:g} s, {'shared' if shared else 'per coil'}: {attacker.requests} requests, "
        f"{judge.pulses} pulses, longest {judge.longest_ms} ms, least gap {judge.least_gap_ms} ms, "
        f"{len(judge.violations)} violations"
    )
    assert judge.violations == []
    assert judge.pulses >= max(1.0, SECONDS / 20.0), "it was let fire: no proof by doing nothing"
