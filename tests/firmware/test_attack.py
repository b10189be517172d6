"""The coil board in C keeps invariant I under a random attack, judged by its pins and the true time.

Twenty thousand requests as a rule; ``make attack`` makes a million.
"""

import os

import pytest
from coil_attack import SETUPS, attack
from firmware_bench import FirmwareBench, loaded

pytestmark = pytest.mark.long

REQUESTS = int(os.environ.get("TORQUER_ATTACK_REQUESTS", "20000"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("setup", SETUPS.values(), ids=SETUPS)
def test_no_attack_breaks_a_limit(library_of, setup, record_property):
    bench = FirmwareBench(loaded(library_of(**setup._asdict())), clock_ms=2**32 - 500_000)
    attacker, judge = attack(setup, bench, REQUESTS // len(SETUPS), SEED)
    found = {
        "requests": attacker.requests,
        "pulses": judge.pulses,
        "longest pulse ms": judge.longest_ms,
        "least gap ms": judge.least_gap_ms,
        "violations": len(judge.violations),
    }
    record_property("attack", found)
    print(f"\n{setup}: {found}")
    assert judge.violations == []
    assert judge.pulses >= attacker.requests // 25, "it was let fire: no proof by doing nothing"
    assert judge.longest_ms == setup.pulse_ms, "the longest pulse that is allowed was driven"
    assert judge.least_gap_ms == setup.backoff_ms, "the next began in the very millisecond in which it may"
