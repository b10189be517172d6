"""Write docs/icd.md and docs/telemetry.md from the DBC and the code; with --check, exit 1 when one is stale.

A template of each, beside this, holds the prose. ``{{name}}`` and ``{{name argument}}`` in it stand for what
is computed: frames from the DBC, rules and their order from the interlock, numbers from the code, worked
tables from a run of the board.
"""

import re
import sys
import tomllib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

import cantools
from cantools.database.can import Database, Message, Signal

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the tree in which this stands, not the one that is installed

from fsw.core.events import SEVERITY, Event
from fsw.core.fdir.faults import CoilFault, Sensor, SensorFault
from fsw.core.monitors import Monitor
from fsw.wire.coil_current import OFF_PART
from fsw.wire.frame import crc8
from fsw.wire.messages import CoilFire, CoilRefusedReason, CoilStatus
from hil_stub import bench, node
from hil_stub.coils import coil_driver, events, interlock, read_back
from hil_stub.wheel import wheel_driver, wheel_guard
from sim.conformance.command import CHECKS
from sim.record.whole_file import replace_text

DBC = ROOT / "fsw" / "wire" / "torquer.dbc"
PAGES = ("icd.md", "telemetry.md")
LIMITS = interlock.CoilLimits(tick_hz=1)

VALUES = {
    "contract_version": node.CONTRACT_VERSION,
    "pulse_ms": LIMITS.pulse_ms,
    "backoff_ms": LIMITS.backoff_ms,
    "max_level": interlock.MAX_LEVEL,
    "units_per_tick": interlock.UNITS_PER_TICK,
    "max_refusals": coil_driver.MAX_REFUSALS,
    "heartbeat_s": node.HEARTBEAT_S,
    "deadman_ms": bench.DEADMAN_MS,
    "off_percent": f"{100.0 * OFF_PART:g}",
    "settle_ms": read_back.ReadBack((0.1, 0.2, 0.3)).settle_ms,
    "current_while_off": f"`{events.CoilEventCode.CURRENT_WHILE_OFF.name.lower()}`",
}


class IcdError(Exception):
    """The sources of the page contradict each other."""


@cache
def database() -> Database:
    return cantools.database.load_file(DBC)


def table(head: tuple[str, ...], rows: Sequence[tuple[object, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def texts(section: str, names: list[str]) -> dict[str, str]:
    """The texts of a section of rules.toml, which must be of exactly these names."""
    with (ROOT / "hil_stub" / "rules.toml").open("rb") as file:
        given: dict[str, str] = tomllib.load(file)[section]
    unmatched = set(given) ^ set(names)
    if unmatched:
        raise IcdError(
            f"hil_stub/rules.toml: [{section}] and the code differ in {', '.join(sorted(unmatched))}"
        )
    return given


def frame(name: str) -> str:
    """A message bit by bit."""
    message = database().get_message_by_name(name)
    head = f"### `{name}`, 0x{message.frame_id:03X}, {message.length} bytes, from {message.senders[0]}"
    return "\n\n".join((head, message.comment or "", bits(message), signals(message)))


def bits(message: Message) -> str:
    cells = {
        signal.start + bit: signal.name if signal.length == 1 else f"{signal.name}.{bit}"
        for signal in message.signals
        for bit in range(signal.length)
    }
    rows = [
        (f"byte {byte}", *(cells.get(8 * byte + bit, "-") for bit in range(7, -1, -1)))
        for byte in range(message.length)
    ]
    return table(("", *(f"bit {bit}" for bit in range(7, -1, -1))), rows)


def signals(message: Message) -> str:
    rows = [
        (f"`{s.name}`", s.start, s.length, "signed" if s.is_signed else "unsigned", *quantity(s), meaning(s))
        for s in sorted(message.signals, key=lambda signal: signal.start)
    ]
    return table(("signal", "first bit", "bits", "kind", "scale", "range", "meaning"), rows)


def quantity(signal: Signal) -> tuple[str, str]:
    unit = f" {signal.unit}" if signal.unit not in (None, "", "1") else ""
    return f"{signal.scale:.17g}{unit}", f"{signal.minimum:.10g} to {signal.maximum:.10g}"


SHARED = {"counter": "see section 1", "crc": "see section 1"}


def meaning(signal: Signal) -> str:
    choices = ", ".join(f"{number} {label}" for number, label in sorted((signal.choices or {}).items()))
    parts = [SHARED.get(signal.name, ""), signal.comment or "", choices]
    return "; ".join(part for part in parts if part)


def crc_example() -> str:
    """A request as on the bus, its CRC computed byte by byte."""
    request = CoilFire(level=-2, coil=1, seq=7, tick=100, duration_ms=3000, counter=5).encode()
    covered = request.can_id.to_bytes(2, "big") + request.data[:-1]
    registers = [f"{crc8(covered[: index + 1]) ^ 0xFF:02X}" for index in range(len(covered))]
    return (
        "Worked example: `COIL_FIRE` with `counter` 5, `level` -2, `coil` 1, `seq` 7, `tick` 100, "
        "`duration_ms` 3000.\nThe CRC goes over these bytes; the register after each of them, from FF:\n\n"
        + table(("byte", *(f"{byte:02X}" for byte in covered)), [("register", *registers)])
        + f"\n\nThe last register XOR FF is {request.data[-1]:02X}. The frame on the bus is, as candump"
        f" writes it, `{request.can_id:03X}#{request.data.hex().upper()}`."
    )


def reason_rows(section: str, reasons: list[CoilRefusedReason]) -> list[tuple[int, str, str]]:
    given = texts(section, [reason.name.lower() for reason in reasons])
    return [(reason.value, f"`{reason.name.lower()}`", given[reason.name.lower()]) for reason in reasons]


def refusals() -> str:
    rows = reason_rows("refusal", list(interlock.REFUSAL_ORDER))
    return table(("", "`reason`", "name", "if"), [(n, *row) for n, row in enumerate(rows, 1)])


def refusals_elsewhere() -> str:
    elsewhere = [reason for reason in CoilRefusedReason if reason not in interlock.REFUSAL_ORDER]
    return table(("`reason`", "name", "if"), reason_rows("refusal_elsewhere", elsewhere))


def states() -> str:
    given = texts("state", [state.name for state in coil_driver.BoardState])
    rows = [(state.value, state.name, given[state.name]) for state in coil_driver.BoardState]
    return table(("`state`", "name", "meaning"), rows)


def coil_events() -> str:
    given = texts("event", [code.name for code in events.CoilEventCode])
    rows = [
        (code.value, f"`{code.name.lower()}`", events.SEVERITY[code].name, given[code.name])
        for code in events.CoilEventCode
    ]
    return table(("`event`", "name", "severity", "if"), rows)


def identifiers() -> str:
    kinds = ("BOOT", "HEARTBEAT", "EVENT")
    ids = {m.name: f"0x{m.frame_id:03X}" for m in database().messages}
    boards = ("MAG", "SUN", "WHEEL")
    return table(("", *kinds), [(board, *(ids[f"{board}_{kind}"] for kind in kinds)) for board in boards])


def wheel_results() -> str:
    given = texts("wheel_result", [result.name.lower() for result in wheel_guard.REFUSAL_ORDER])
    rows = [
        (n, result.value, f"`{result.name.lower()}`", given[result.name.lower()])
        for n, result in enumerate(wheel_guard.REFUSAL_ORDER, 1)
    ]
    return table(("", "`result`", "name", "if"), rows)


def wheel_states() -> str:
    return ", ".join(f"{state.value} {state.name}" for state in wheel_driver.WheelBoardState)


def wheel_events() -> str:
    given = texts("wheel_event", [code.name for code in wheel_driver.WheelEventCode])
    rows = [
        (code.value, f"`{code.name.lower()}`", wheel_driver.SEVERITY[code].name, given[code.name])
        for code in wheel_driver.WheelEventCode
    ]
    return table(("`event`", "name", "severity", "if"), rows)


def board_in(tick: int, tick_hz: int, duration_ms: int) -> coil_driver.CoilDriver:
    """A board booted in tick 0 that has just accepted a pulse of coil 1 at level -2 in answer to ``tick``."""
    board = coil_driver.CoilDriver(interlock.CoilLimits(tick_hz))
    for now in range(tick + 1):
        board.begin_tick(now, 0.0)
    board.receive(CoilFire(-2, 1, 7, tick & 0xFF, duration_ms).encode())
    if board.drive().level != -2:
        raise IcdError("the worked example is refused")
    return board


def status_of(board: coil_driver.CoilDriver, tick: int) -> CoilStatus:
    frames = [f for f in board.begin_tick(tick, 0.0) if f.can_id == CoilStatus.ID]
    return CoilStatus.decode(frames[0].data)


COLUMNS = ("level", "coil", "remaining_ms", "lockout_ms", "seq")


def status_table(first: str, rows: Sequence[tuple[str | int, CoilStatus]]) -> str:
    cells = [(label, *(getattr(status, name) for name in COLUMNS)) for label, status in rows]
    return table((first, *(f"`{name}`" for name in COLUMNS)), cells)


def pulse_table(tick_hz: str) -> str:
    hz, duration_ms = int(tick_hz), {"1": 3000, "2": 2250}[tick_hz]
    fired = 100 * hz
    board = board_in(fired, hz, duration_ms)
    ticks = [*range(fired + 1, fired + 7), fired + 100 * hz, fired + 103 * hz - 1, fired + 103 * hz]
    statuses = [(tick, status_of(board, tick)) for tick in range(fired + 1, ticks[-1] + 1)]
    return status_table("tick", [row for row in statuses if row[0] in ticks])


def skip_table() -> str:
    rows = [(f"n = {n}", status_of(board_in(100, 1, 3000), 100 + n)) for n in (1, 2, 3, 4, 103)]
    return status_table("", rows)


def checks() -> str:
    rows = [
        (
            f"`{check.run.__name__}`",
            " ".join((check.run.__doc__ or "").split()),
            "yes" if check.power else "no",
        )
        for check in CHECKS
    ]
    return table(("check", "demands", "drives coils"), rows)


def fsw_events() -> str:
    """The meaning of an argument is the remark beside the event's number."""
    source = (ROOT / "fsw" / "core" / "events.py").read_text(encoding="utf-8")
    meaning = dict(re.findall(r"^    ([A-Z_]+) = \d+  # (.+)$", source, re.MULTILINE))
    rows = [
        (event.value, f"`{event.name.lower()}`", SEVERITY[event].name, meaning[event.name]) for event in Event
    ]
    return table(("`event`", "name", "severity", "`argument`"), rows)


def fsw_numbers() -> str:
    kinds = {"sensor": Sensor, "its fault": SensorFault, "fault of a coil": CoilFault, "monitor": Monitor}
    rows = [(of, ", ".join(f"{one.value} {one.name}" for one in kind)) for of, kind in kinds.items()]
    return table(
        ("of", "numbers"), [*rows, ("reason of a refusal, mode", "as in `COIL_REFUSED`, `NAV_QUALITY`")]
    )


PIECES: dict[str, Callable[..., str]] = {
    "checks": checks,
    "frame": frame,
    "value": lambda name: str(VALUES[name]),
    "crc_example": crc_example,
    "refusals": refusals,
    "refusals_elsewhere": refusals_elsewhere,
    "states": states,
    "events": coil_events,
    "identifiers": identifiers,
    "pulse_table": pulse_table,
    "skip_table": skip_table,
    "fsw_events": fsw_events,
    "fsw_numbers": fsw_numbers,
    "wheel_events": wheel_events,
    "wheel_results": wheel_results,
    "wheel_states": wheel_states,
}


def page(name: str) -> str:
    """The page of that name, made of its template."""
    template = ROOT / "tools" / f"{name}.in"

    def piece(match: re.Match[str]) -> str:
        name, argument = match.groups()
        if name not in PIECES:
            raise IcdError(f"{template.name}: there is no {{{{{name}}}}}")
        return PIECES[name](argument) if argument else PIECES[name]()

    return re.sub(r"\{\{(\w+)(?: (\w+))?\}\}", piece, template.read_text(encoding="utf-8"))


def main() -> int:
    code = 0
    for name in PAGES:
        target, text = ROOT / "docs" / name, page(name)
        if "--check" not in sys.argv:
            replace_text(target, text)
            continue
        stale = not target.exists() or target.read_text(encoding="utf-8") != text
        print(f"{name} is {'stale: run tools/generate_icd.py' if stale else 'as its sources say'}")
        code |= stale
    return int(code)


if __name__ == "__main__":
    sys.exit(main())
