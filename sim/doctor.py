"""``torquer doctor``: what this machine has of what flights, CAN interfaces and benches need."""

import os
import re
import shutil
import socket
import sys
import time
from collections.abc import Callable, Iterator
from enum import StrEnum
from importlib.metadata import PackageNotFoundError, requires, version
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile
from typing import NamedTuple

from fsw.compiled import KERNEL, ROOT, SWITCH, standing
from sim.console import answer, say

SYSTEM = Path("/sys/class/net")
_ARPHRD_CAN = "280"
LEAST_PYTHON = (3, 11)
LEAST_FREE_MB = 500.0
"""A flight of ten orbits leaves some 60 MB."""
EARLIEST_S = 1_735_689_600.0
"""2025-01-01: a clock before it names runs wrongly."""
MOST_OVERSHOOT_MS = 5.0
"""Of a sleep of a millisecond: a bench at 10 Hz allows half a tick."""
_REQUIREMENT = re.compile(
    r"(?P<name>[\w.-]+)(?:\[.*\])?\s*>=(?P<least>[\d.]+)(?:.*extra == ['\"](?P<extra>\w+)['\"])?"
)


class Presence(StrEnum):
    """How something stands."""

    OK = "ok"
    OPTIONAL = "optional"
    """It is not there, and flights do without."""
    MISSING = "MISSING"


class Finding(NamedTuple):
    """One thing that was looked at.

    Attributes:
        name: what.
        presence: how it stands.
        found: what is there.
        remedy: what to type; empty where nothing has to be.
    """

    name: str
    presence: Presence
    found: str
    remedy: str = ""


def examine() -> list[Finding]:
    """Look at everything."""
    return [finding for look in _LOOKS for finding in look()]


def report(findings: list[Finding]) -> int:
    """Print the findings: 1 if something that flights need is missing."""
    width = max(len(finding.name) for finding in findings)
    for finding in findings:
        missing = finding.presence is Presence.MISSING
        say(f"{finding.presence.value:<9} {finding.name:<{width}} {finding.found}", failed=missing)
        if finding.remedy:
            say(f"{'':<9} {'':<{width}} type: {finding.remedy}", failed=missing)
    ok = all(finding.presence is not Presence.MISSING for finding in findings)
    say("all that flights need is there" if ok else "something that flights need is missing", failed=not ok)
    answer({"ok": ok, "findings": [finding._asdict() for finding in findings]})
    return int(not ok)


def can_interfaces(system: Path = SYSTEM) -> dict[str, bool]:
    """The CAN interfaces of this Linux machine by name, and whether each is up; none elsewhere."""
    return {
        folder.name: bool(int(_text(folder / "flags") or "0", 16) & 1)
        for folder in (sorted(system.iterdir()) if system.is_dir() else ())
        if _text(folder / "type") == _ARPHRD_CAN
    }


def _text(file: Path) -> str:
    return file.read_text(encoding="ascii").strip() if file.is_file() else ""


def _python() -> Iterator[Finding]:
    found = f"{sys.version.split()[0]} in {sys.prefix}, {os.cpu_count() or 1} processors"
    ok = sys.version_info >= LEAST_PYTHON
    least = ".".join(map(str, LEAST_PYTHON))
    remedy = "" if ok else f"python{least} -m venv .venv && .venv/bin/pip install torquer"
    yield Finding("Python", Presence.OK if ok else Presence.MISSING, found, remedy)


def _packages() -> Iterator[Finding]:
    """The packages that torquer requires, and its extras; those of developers are no concern of a user."""
    wanted: dict[str, list[tuple[str, str]]] = {}
    for line in requires("torquer") or ():
        match = _REQUIREMENT.match(line)
        if match is not None:
            wanted.setdefault(match["extra"] or "", []).append((match["name"], match["least"]))
    wanted.pop("dev", None)
    for extra, packages in wanted.items():
        lacking = list(dict.fromkeys(text for name, least in packages if (text := _lacking(name, least))))
        name = f"torquer[{extra}]" if extra else "packages"
        found = ", ".join(lacking) or ", ".join(f"{package} {version(package)}" for package, _ in packages)
        absent = Presence.OPTIONAL if extra else Presence.MISSING
        remedy = f"pip install '{name if extra else 'torquer'}'" if lacking else ""
        yield Finding(name, absent if lacking else Presence.OK, found, remedy)


def _lacking(name: str, least: str) -> str:
    """What is wrong with a package; empty where nothing is."""
    try:
        there = version(name)
    except PackageNotFoundError:
        return f"{name} is not installed"
    return "" if _numbers(there) >= _numbers(least) else f"{name} {there} is older than {least}"


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(map(int, re.findall(r"\d+", text)[:3]))


def _flight_code() -> Iterator[Finding]:
    """Whether it runs compiled, to the same bits in less time, and whether the filter's kernel is there."""
    found, in_sources = standing(), (ROOT / "Makefile").is_file()
    install = "pip install --force-reinstall --no-deps torquer"
    build = "make venv" if in_sources else f"TORQUER_COMPILED=1 {install}"
    remedy = f"unset {SWITCH}" if os.environ.get(SWITCH) else f"{build}, where there is a C compiler"
    if found.reason:
        yield Finding("flight code", Presence.OPTIONAL, str(found), remedy)
    else:
        yield Finding("flight code", Presence.OK, str(found))
    if find_spec(KERNEL) is None:
        remedy = f"{'make venv' if in_sources else install}, where there is a C compiler"
        yield Finding(
            "filter's kernel", Presence.OPTIONAL, "not built of this source: filterpy flies", remedy
        )
    else:
        yield Finding("filter's kernel", Presence.OK, "built")


def _can() -> Iterator[Finding]:
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except (AttributeError, OSError) as error:
        remedy = "sudo modprobe can_raw" if sys.platform == "linux" else ""
        yield Finding(
            "SocketCAN", Presence.OPTIONAL, f"the kernel has none ({error}); --bus loop needs none", remedy
        )
    else:
        yield Finding("SocketCAN", Presence.OK, "the kernel has it")
    interfaces = can_interfaces()
    for name, is_up in interfaces.items():
        remedy = "" if is_up else f"sudo ip link set {name} up"
        yield Finding(name, Presence.OK if is_up else Presence.OPTIONAL, "up" if is_up else "down", remedy)
    if "vcan0" not in interfaces:
        remedy = "sudo modprobe vcan && sudo ip link add vcan0 type vcan && sudo ip link set vcan0 up"
        yield Finding("vcan0", Presence.OPTIONAL, "there is none; --bus loop and virtual need none", remedy)


def _folders() -> Iterator[Finding]:
    here = Path.cwd()
    try:
        with TemporaryFile(dir=here):
            pass
    except OSError as error:
        yield Finding("folder", Presence.MISSING, f"{here}: {error.strerror}", "cd to a folder of your own")
    else:
        yield Finding("folder", Presence.OK, f"{here} can be written: runs are put into runs/ here")
    free_mb = shutil.disk_usage(here).free / 1e6
    ok = free_mb >= LEAST_FREE_MB
    remedy = "" if ok else "rm -r runs/OLD-RUN, or --compress"
    yield Finding("disk", Presence.OK if ok else Presence.MISSING, f"{free_mb:.0f} MB free", remedy)


def _permissions() -> Iterator[Finding]:
    ports = [path for path in Path("/dev").glob("tty[AU][CS][MB]*") if not os.access(path, os.R_OK | os.W_OK)]
    for path in ports:
        try:
            remedy = f"sudo usermod -aG {path.group()} $USER, and log in again"
        except KeyError:  # a container may know no name of the host's group
            remedy = f"sudo chmod a+rw {path}"
        yield Finding(path.name, Presence.OPTIONAL, f"serial adapter {path} may not be used", remedy)


def _clock() -> Iterator[Finding]:
    now_s = time.time()
    if now_s < EARLIEST_S:
        yield Finding(
            "clock",
            Presence.MISSING,
            time.strftime("%Y-%m-%d", time.gmtime(now_s)),
            "sudo timedatectl set-ntp true",
        )
    overshoots_ms = sorted(_overshoot_ms() for _ in range(50))
    worst_ms = overshoots_ms[-2]
    ok = worst_ms <= MOST_OVERSHOOT_MS
    found = f"a sleep of 1 ms is up to {worst_ms:.1f} ms late"
    remedy = "" if ok else "torquer hil on a machine with less to do"
    yield Finding(
        "timing", Presence.OK if ok else Presence.OPTIONAL, f"{found}; torquer hil needs it", remedy
    )


def _overshoot_ms() -> float:
    began_s = time.monotonic()
    time.sleep(0.001)
    return 1e3 * (time.monotonic() - began_s) - 1.0


_LOOKS: tuple[Callable[[], Iterator[Finding]], ...] = (
    _python,
    _packages,
    _flight_code,
    _can,
    _permissions,
    _folders,
    _clock,
)
