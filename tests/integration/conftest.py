"""Fixtures for tests on real CAN interfaces. Where there are none: ``tests/with-vcan pytest -m vcan``."""

import os
import subprocess

import pytest

from fsw.io.socketcan import interface_is_up

CAN_FIXTURES = {"vcan0", "own_interface"}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    for item in items:
        if CAN_FIXTURES & set(getattr(item, "fixturenames", ())):
            item.add_marker("vcan")


def missing(what):
    if os.environ.get("TORQUER_REQUIRE_VCAN") == "1":
        pytest.fail(f"{what}, but TORQUER_REQUIRE_VCAN=1 requires it")
    pytest.skip(f"{what}: make test-vcan runs this test where there is one")


@pytest.fixture
def vcan0():
    """The name of an interface that is up, and that others may be talking on."""
    if not interface_is_up("vcan0"):
        missing("there is no CAN interface vcan0 here")
    return "vcan0"


@pytest.fixture
def own_interface():
    """The name of a fresh vcan interface that the test may torment."""
    name = f"vcan{os.getpid() % 100_000 + 1}"
    made = subprocess.run(["ip", "link", "add", name, "type", "vcan"], check=False, capture_output=True)
    if made.returncode:
        missing("no CAN interface can be made here")
    subprocess.run(["ip", "link", "set", name, "up"], check=True)
    yield name
    subprocess.run(["ip", "link", "delete", name], check=False, capture_output=True)
