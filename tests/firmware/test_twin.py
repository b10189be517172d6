"""The coil board in C is the stub's twin: each frame that it sends and each pin that it drives is the stub's.

Under attack, with noise on the bus and faults of the current.
"""

import os
import re
from random import Random

import pytest
from coil_attack import SETUPS, attack
from firmware_bench import BOARD
from twins import Twins

from fsw.wire.messages import _SHAPES

pytestmark = pytest.mark.long

REQUESTS = int(os.environ.get("TORQUER_ATTACK_REQUESTS", "20000"))
SEED = int(os.environ.get("TORQUER_ATTACK_SEED", "20150327"))


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("setup", SETUPS.values(), ids=SETUPS)
def test_they_send_and_drive_the_same(library_of, setup):
    twins = Twins(setup, library_of(**setup._asdict()), Random(f"twins/{SEED}"))
    attacker, judge = attack(setup, twins, REQUESTS // len(SETUPS), SEED)
    for _ in range(61 * setup.tick_hz):  # in peace, until a heartbeat is due
        attacker.sync(attacker.tick)
        attacker.answer(attacker.tick)
        attacker.target.wait(setup.period_ms)
    assert judge.violations == []
    assert twins.compared > REQUESTS // len(SETUPS)
    assert twins.kinds == {0x100, 0x108, 0x420, 0x520, 0x620}, "each of its messages was among them"


def test_the_gate_knows_every_message_of_the_bus():
    table = (BOARD / "src" / "frame.c").read_text()
    rows = re.findall(r"\{0x([0-9A-F]+)U, (\d)U, (true|false)\}", table)
    shapes = {int(can_id, 16): (int(length), sealed == "true") for can_id, length, sealed in rows}
    assert shapes == {can_id: (length, register >= 0) for can_id, (length, register) in _SHAPES.items()}
