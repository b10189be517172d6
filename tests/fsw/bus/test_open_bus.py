"""Specs: what they stand for, and the sentence a person gets for a wrong one."""

import subprocess
import sys

import pytest

from fsw.bus.interface import BusError
from fsw.bus.open_bus import open_bus, resolve


@pytest.mark.parametrize(
    ("spec", "full"),
    [
        ("loop", "loop:28011"),
        ("loop:5000", "loop:5000"),
        ("socketcan:can1", "socketcan:can1"),
        ("slcan:/dev/ttyACM0", "slcan:/dev/ttyACM0"),
        ("slcan:COM3", "slcan:COM3"),
    ],
)
def test_a_spec_resolves_to_its_full_form(spec, full):
    assert resolve(spec) == full


@pytest.mark.parametrize(("up", "full"), [(True, "socketcan:vcan0"), (False, "loop:28011")])
def test_auto_is_vcan0_where_it_is_up_and_else_loop(monkeypatch, up, full):
    asked = []
    monkeypatch.setattr("fsw.bus.socketcan.interface_is_up", lambda name: asked.append(name) or up)
    assert resolve("auto") == full
    assert asked == ["vcan0"]


@pytest.mark.parametrize(
    ("spec", "says"),
    [
        (
            "canopen:1",
            "unknown bus 'canopen:1': use loop[:PORT], socketcan:NAME, slcan:PORT, can:INTERFACE:CHANNEL",
        ),
        ("", "unknown bus ''"),
        ("auto:vcan1", "unknown bus 'auto:vcan1'"),
        ("socketcan", "names no interface"),
        ("socketcan:", "names no interface"),
        ("slcan", "names no serial port"),
        ("loop:", "names no TCP port"),
        ("loop:0", "names no TCP port"),
        ("loop:65536", "names no TCP port"),
        ("loop:" + "9" * 5000, "names no TCP port"),
        ("loop:-1", "names no TCP port"),
        ("loop:²", "names no TCP port"),
        ("loop:here", "names no TCP port"),
        ("virtual", "joins nodes of one process"),
    ],
)
def test_a_wrong_spec_is_one_sentence(spec, says):
    with pytest.raises(BusError) as refused:
        open_bus(spec)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_missing_interface_is_one_sentence():
    with pytest.raises(BusError, match=r"'nocan7'|no SocketCAN|needs Linux"):
        open_bus("socketcan:nocan7")


def test_the_loop_opens_without_python_can():
    program = "import sys; import fsw.bus.link, fsw.bus.open_bus; sys.exit('can' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0
