"""docs/icd.md and docs/telemetry.md are what DBC, rules and code say, and a page that is not is noticed."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import cantools
import pytest
from interlocks import after_ticks

from fsw.wire.messages import CoilFire, CoilRefusedReason, WheelStatusResult
from hil_stub.coils import interlock
from hil_stub.coils.coil_driver import CoilLimits
from hil_stub.wheel import wheel_guard

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "icd.md"


def generate(root, *arguments):
    return subprocess.run(
        [sys.executable, "-P", str(root / "tools" / "generate_icd.py"), *arguments],
        cwd=root,
        check=False,
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.fixture
def copy(tmp_path):
    """A copy of all that the page is made of, and of the page."""
    pages = ("tools/icd.md.in", "docs/icd.md", "tools/telemetry.md.in", "docs/telemetry.md")
    for name in (*pages, "tools/generate_icd.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for package in ("fsw", "hil_stub", "sim"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


@pytest.mark.long
def test_the_page_is_fresh():
    done = generate(ROOT, "--check")
    assert done.returncode == 0, done.stdout + done.stderr


def test_make_lint_checks_it():
    recipe = (ROOT / "Makefile").read_text().partition("\nlint:")[2].partition("\n\n")[0]
    assert "tools/generate_icd.py --check" in recipe


CHANGES = {
    "a signal of the DBC": ("fsw/wire/torquer.dbc", "duration_ms : 32|16", "duration_ms : 32|15"),
    "a limit": ("hil_stub/coils/interlock.py", "backoff_ms: int = 100_000", "backoff_ms: int = 90_000"),
    "a rule's text": ("hil_stub/rules.toml", "a coil is on", "one is on"),
    "the prose": ("tools/icd.md.in", "A gap in", "Some gap in"),
    "what the board tells": ("hil_stub/coils/coil_driver.py", "else tick % 3", "else 0"),
    "an event's severity": (
        "hil_stub/coils/events.py",
        "NO_CURRENT: Severity.ERROR",
        "NO_CURRENT: Severity.FATAL",
    ),
    "the dead-man": ("hil_stub/bench.py", "DEADMAN_MS: Final = 5000", "DEADMAN_MS: Final = 4000"),
    "what an argument is": ("fsw/core/events.py", "# the new mode", "# the old mode"),
    "a monitor": ("fsw/core/monitors.py", "ORBIT_KNOWN = 8", "ORBIT_KNOWN = 18"),
    "the CRC": ("fsw/wire/frame.py", "_crc8_table(0x1D)", "_crc8_table(0x1F)"),
    "the order of refusals": (
        "hil_stub/coils/interlock.py",
        "REFUSAL_ORDER: Final = tuple(reason for reason, _ in _REFUSED_IF)",
        "REFUSAL_ORDER: Final = tuple(reason for reason, _ in _REFUSED_IF[::-1])",
    ),
}


@pytest.mark.long
@pytest.mark.parametrize(("name", "old", "new"), CHANGES.values(), ids=CHANGES)
def test_a_stale_page_is_noticed(copy, name, old, new):
    changed = copy / name
    assert old in changed.read_text()
    changed.write_text(changed.read_text().replace(old, new))
    done = generate(copy, "--check")
    assert (done.returncode, "stale" in done.stdout) == (1, True), done.stderr


@pytest.mark.long
@pytest.mark.parametrize(
    ("old", "new"), [("wrong_tick", "wrong_tock"), ('[state]\nREADY = "', '[state]\nX = "')]
)
def test_a_rule_without_a_text_is_an_error(copy, old, new):
    rules = copy / "hil_stub" / "rules.toml"
    rules.write_text(rules.read_text().replace(old, new, 1))
    done = generate(copy)
    assert done.returncode != 0
    assert "rules.toml" in done.stderr


def test_the_worked_example_is_what_another_codec_makes():
    (can_id, data) = re.search(r"as candump writes it, `(\w{3})#(\w+)`", PAGE.read_text()).groups()
    decoded = cantools.database.load_file(ROOT / "fsw/wire/torquer.dbc").decode_message(
        int(can_id, 16), bytes.fromhex(data), decode_choices=False
    )
    done = {"level": -2, "coil": 1, "seq": 7, "tick": 100, "duration_ms": 3000, "counter": 5}
    assert {name: decoded[name] for name in done} == done
    register = 0xFF
    for byte in bytes.fromhex(f"0{can_id}{data}")[:-1]:
        register ^= byte
        for _ in range(8):
            register = (register << 1 ^ 0x1D if register & 0x80 else register << 1) & 0xFF
    assert register ^ 0xFF == decoded["crc"]


def test_the_order_of_refusals_is_how_the_board_judges():
    """A request that breaks rule n and all that follow is refused for n."""
    limits = CoilLimits(1)
    state = after_ticks(interlock.boot(limits), 100)
    interlock.accept(state, CoilFire(coil=0, level=1, duration_ms=3000, seq=5, tick=300 & 0xFF), limits)
    asked = CoilFire(coil=3, level=7, duration_ms=0, seq=5, tick=0)
    mended = [{"tick": 300 & 0xFF}, {"seq": 6}, {"coil": 0}, {"level": 1}, {"duration_ms": 1}]
    found = []
    for mend in [{}, *mended]:
        asked = asked.replace(**mend)
        found.append(interlock.judge(state, asked, 300, limits))
    found.append(interlock.judge(after_ticks(state, 3), asked, 300, limits))
    assert tuple(found) == interlock.REFUSAL_ORDER
    assert refusals()[: len(interlock.REFUSAL_ORDER)] == named(interlock.REFUSAL_ORDER)
    assert set(CoilRefusedReason) > set(interlock.REFUSAL_ORDER)


def test_the_order_of_the_wheels_refusals_is_how_its_board_judges():
    """Those of the coils stand before them; what the table of results has beyond them is no refusal."""
    order = wheel_guard.REFUSAL_ORDER
    assert refusals()[len(interlock.REFUSAL_ORDER) :] == named(order)
    assert {result.name for result in set(WheelStatusResult) - set(order)} == {"NONE", "DRIVEN", "MALFORMED"}


def refusals():
    """(number, name) of each numbered refusal on the page, in its order."""
    listed = re.findall(r"^\| \d \| (\d+) \| `(\w+)`", PAGE.read_text(), re.MULTILINE)
    return [(int(number), name.upper()) for number, name in listed]


def named(order):
    return [(reason.value, reason.name) for reason in order]
