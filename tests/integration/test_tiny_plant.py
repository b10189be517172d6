"""The plant of docs/own-plant.md: of the standard library alone, and answered as the page says."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from fsw.core.telemetry import Event
from fsw.wire.messages import FswBoot, FswEvent, NavAttitude, TickDone

EXAMPLE = Path(__file__).parents[2] / "examples" / "tiny_plant.py"
EPOCH = 1_427_424_417


def flown(start, wait_for, port, ticks, epoch):
    """(identifier, data) of each frame that the tiny plant was answered."""
    node = start("torquer", "fsw", "microsat", "--bus", f"loop:{port}")
    wait_for(node, "fsw on")
    words = [sys.executable, str(EXAMPLE), str(port), str(ticks), str(epoch)]
    lines = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout.split()
    frames = (line.partition("#") for line in lines)
    return [(int(identifier, 16), bytes.fromhex(data)) for identifier, _, data in frames]


def test_it_needs_nothing_but_the_standard_library():
    tree = ast.parse(EXAMPLE.read_text(encoding="utf-8"))
    imported = {name.name for node in ast.walk(tree) if isinstance(node, ast.Import) for name in node.names}
    assert imported <= sys.stdlib_module_names
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]


def test_without_a_hub_it_says_what_is_missing(port):
    words = [sys.executable, str(EXAMPLE), str(port), "20", str(EPOCH)]
    ended = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    assert ended.returncode == 1
    assert ended.stderr == f"nothing listens on port {port}: start torquer fsw --bus loop:{port} first\n"


@pytest.mark.long
def test_each_tick_is_answered_and_closed(start, wait_for, port):
    answers = flown(start, wait_for, port, 20, EPOCH)
    assert answers[0][0] == FswBoot.ID
    assert [TickDone.decode(data).tick for can_id, data in answers if can_id == TickDone.ID] == list(
        range(20)
    )
    assert sum(can_id == NavAttitude.ID for can_id, _ in answers) == 20


@pytest.mark.long
@pytest.mark.parametrize("off_s", [0, 600])
def test_a_time_that_is_not_the_table_s_is_reported_once(start, wait_for, port, off_s):
    answers = flown(start, wait_for, port, 20, EPOCH + off_s)
    events = [FswEvent.decode(data) for can_id, data in answers if can_id == FswEvent.ID]
    told = [event.argument for event in events if event.event == Event.TIME_MISMATCH]
    assert told == ([off_s] if off_s else [])
