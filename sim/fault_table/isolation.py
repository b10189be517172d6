"""Which unit the flight software isolates, according to its events; units have the names that rows use."""

from collections.abc import Callable
from math import inf

from fsw.core.events import Event as Number
from fsw.core.monitors import Monitor
from fsw.wire.messages import Mode
from hil_stub.coils.events import CoilEventCode
from sim.fault_rig.record import FaultFlightRecord, ReportedEvent
from sim.fault_table.row import Bounds, FaultRow, RowFault
from sim.faults.kinds import KINDS
from sim.report.event_words import UNITS, isolated_unit

# --- Where a fault shows: what the flight software has no means to see it need not report


def onset_tick(fault: RowFault, record: FaultFlightRecord) -> int:
    """The tick in which a fault of the row begins."""
    return (record.onset or 0) + round(fault.after_s * record.tick_hz)


def shows(fault: RowFault, record: FaultFlightRecord) -> bool:
    """Whether the flight has a tick in which a fault can be seen: by its kind in sunlight, shadow or both.

    A cell that is dead, or weak, is as it should be where the Sun does not shine on it.
    """
    first = onset_tick(fault, record)
    end = len(record.lit) if fault.lasts_s == inf else first + round(fault.lasts_s * record.tick_hz)
    if fault.kind in ("cell_dead", "cell_scaled"):
        return any(int(fault.unit.removeprefix("cell ")) in cells for cells in record.lit_cells[first:end])
    in_light, in_shadow = _shows_in_light(fault), _shows_in_shadow(fault)
    return any(in_light if lit else in_shadow for lit in record.lit[first:end])


def _shows_in_light(fault: RowFault) -> bool:
    """A lamp, which is light from the Earth that leaves the Sun where it is, is nothing beside the Sun."""
    return fault.kind != "albedo" or _parameter(fault, "part") > 0.0


def _shows_in_shadow(fault: RowFault) -> bool:
    """A sensor of the Sun has nothing to be wrong about there, unless it is the fault that it sees one."""
    if fault.kind in ("albedo", "sun_frozen", "extreme_codes"):
        return True
    if fault.kind == "cell_stuck":
        return _parameter(fault, "percent") > 0.0
    return fault.unit != "sun sensor" and not fault.unit.startswith("cell ")


def _parameter(fault: RowFault, name: str) -> float:
    return fault.parameters.get(name, KINDS[fault.kind].parameters[name].default)


# --- The checks

PULSE_S = 3
LEAST_PULSES = 5
"""Pulses of a coil that suffice to isolate it if it is faulty."""
UnitOf = Callable[[ReportedEvent], str]
SECOND_SENDER, CLOCK = "second sender", "clock"

_UNIT_OF_MONITOR = {
    Monitor.FIELD_FRESH: "magnetometer",
    Monitor.COIL_STATUS_FRESH: "coil board",
    Monitor.COIL_AS_COMMANDED: "coil board",
    Monitor.NO_SECOND_SENDER: SECOND_SENDER,
    Monitor.TIME_AGREES: CLOCK,
}


def _unit_of_trip(event: ReportedEvent) -> str:
    monitor = Monitor(event.argument)
    return _UNIT_OF_MONITOR.get(monitor, monitor.name)


MONITORS: dict[int, UnitOf] = {Number.MONITOR_TRIPPED: _unit_of_trip}
"""Units by the event of a monitor: a board is silent, or acts without a request."""


def can_isolate(unit: str) -> bool:
    """Whether the flight software has an event that isolates this unit."""
    return unit in (SECOND_SENDER, CLOCK) or any(unit in units.values() for units in UNITS.values())


def isolations(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each isolation of a unit."""
    units = [(event.tick, _isolated_by(event)) for event in record.events]
    return [(tick, unit) for tick, unit in units if unit is not None]


def _isolated_by(event: ReportedEvent) -> str | None:
    if event.number == Number.SECOND_SENDER:
        return SECOND_SENDER
    if (event.number, event.argument) == (Number.MONITOR_TRIPPED, Monitor.TIME_AGREES):
        return CLOCK
    return isolated_unit(event.number, event.argument)


def monitor_trips(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each trip of a monitor."""
    return [
        (event.tick, MONITORS[event.number](event)) for event in record.events if event.number in MONITORS
    ]


_WITHOUT_A_COIL = {
    CoilEventCode.DEAD_MAN: "plant",
    CoilEventCode.CURRENT_WHILE_OFF: "coil driver",
    CoilEventCode.CURRENT_WRONG: "coil driver",  # of the driven coil, or of another besides it
    CoilEventCode.SELF_TEST_FAILED: "coil driver",
}


def board_identifications(record: FaultFlightRecord) -> list[tuple[int, str]]:
    """(tick, unit) of each unit that the coil driver board has identified by its read-back."""
    return [
        (event.tick, _WITHOUT_A_COIL.get(CoilEventCode(event.number), f"coil {event.coil}"))
        for event in record.board_events
    ]


def isolation_s(fault: RowFault, record: FaultFlightRecord) -> float | None:
    """Time from the onset of a fault to the isolation of its unit [s]; None: it is not isolated."""
    onset = onset_tick(fault, record)
    ticks = [tick for tick, unit in isolations(record) if unit == fault.unit and tick >= onset]
    return (ticks[0] - onset) / record.tick_hz if ticks else None


def doubt_s(fault: RowFault, record: FaultFlightRecord) -> float | None:
    """Time from the onset of a sensor's fault until the sensors are reported to disagree [s]; None: never."""
    onset = onset_tick(fault, record)
    doubted = _doubted(onset, record)
    return None if doubted == inf or fault.unit.startswith("coil ") else (doubted - onset) / record.tick_hz


def _given_up_s(fault: RowFault, record: FaultFlightRecord) -> float | None:
    """Duration of a fault in the shadow, if the attitude is not valid at its end [s]; otherwise None."""
    first, hz = onset_tick(fault, record), record.tick_hz
    if fault.lasts_s == inf:
        return None
    end = first + round(fault.lasts_s * hz)
    if end > len(record.lit) or any(record.lit[first:end]):
        return None
    return fault.lasts_s if record.error_deg[end - 1] is None else None


def _doubted(onset: int, record: FaultFlightRecord) -> float:
    """The first tick from the onset on in which the sensors are reported to disagree; infinite: none."""
    ticks = (event.tick for event in record.events if event.number == Number.SENSORS_DISAGREE)
    return min((tick for tick in ticks if tick >= onset), default=inf)


def isolates_faulty_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool | None, str]:
    """Each faulty unit is isolated, in the time that the row gives it, and after the onset no other.

    None where a fault has no tick in which it could be seen.
    """
    return _isolates(row, record, lambda fault: isolation_s(fault, record))


def isolates_or_disputes_faulty_unit(
    row: FaultRow, record: FaultFlightRecord, bounds: Bounds
) -> tuple[bool | None, str]:
    """Likewise, but where the faulty sensor is not observable it is enough to report that they disagree.

    During a fault that begins and ends in the shadow there is only one sensor: it is enough that the attitude
    is not valid when it ends.
    """

    def found_s(fault: RowFault) -> float | None:
        named_s = isolation_s(fault, record)
        found = doubt_s(fault, record) if named_s is None else named_s
        return _given_up_s(fault, record) if found is None or found > row.within_s else found

    return _isolates(row, record, found_s)


def _isolates(
    row: FaultRow, record: FaultFlightRecord, found_s: Callable[[RowFault], float | None]
) -> tuple[bool | None, str]:
    onset, units = record.onset or 0, [fault.unit for fault in row.faults]
    for tick, unit in isolations(record):
        if tick >= onset and unit not in units:
            return False, f"{unit} isolated in place of {' or '.join(units)} in tick {tick}"
    after_s, undecided = [], []
    for fault in row.faults:
        if not fault.shows:
            continue
        if not shows(fault, record):
            undecided.append(f"the fault of {fault.unit} never shows")
            continue
        named_s = found_s(fault)
        if named_s is None:
            holds, finding = _not_isolated(row, fault, record)
            if holds is False:
                return False, finding
            undecided.append(finding)
        elif named_s > row.within_s:
            return False, f"{fault.unit} found after {named_s:.0f} s, later than {row.within_s:g} s"
        else:
            after_s.append(f"{named_s:.0f} s")
    if undecided or not after_s:
        return None, ", ".join(undecided)
    return True, f"found after {', '.join(after_s)}"


def isolates_no_healthy_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """No unit is isolated, except that a faulty one may be after the onset of its fault."""
    onsets = {fault.unit: onset_tick(fault, record) for fault in row.faults}
    healthy = [(tick, unit) for tick, unit in isolations(record) if tick < onsets.get(unit, inf)]
    return not healthy, f"{healthy[0][1]} isolated in tick {healthy[0][0]}" if healthy else ""


def uses_unit_again(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """A coil is readmitted, fired once its fault has passed, and not isolated again."""
    coil = int(row.unit.removeprefix("coil "))
    back = [
        event.tick
        for event in record.events
        if event.number == Number.COIL_READMITTED and event.argument // 100 == coil + 1
    ]
    if not back:
        return False, f"{row.unit} is not brought back"
    fired = zip(record.request_ticks, record.request_coils, strict=True)
    count = sum(tick > max(back[-1], record.end or 0) and one == coil for tick, one in fired)
    again = any(tick > back[-1] and unit == row.unit for tick, unit in isolations(record))
    return count > 0 and not again, f"{row.unit} fired {count} times" + ", and isolated again" * again


def _not_isolated(row: FaultRow, fault: RowFault, record: FaultFlightRecord) -> tuple[bool | None, str]:
    """A coil shows its fault only while it is on: a few pulses are needed as evidence.

    Those after a faulty sensor has made the sensors disagree do not count: there is no estimate to judge by.
    Nor is there one for a coil that is stuck on before an attitude was ever valid.
    """
    if not can_isolate(fault.unit):
        return None, f"fsw cannot isolate {fault.unit} yet"
    onset = onset_tick(fault, record)
    if "stuck" in row.expect and all(error is None for error in record.error_deg[:onset]):
        return None, f"{fault.unit} is not isolated, and no attitude was valid before its fault"
    if not fault.unit.startswith("coil ") or "stuck" in row.expect:
        return False, f"{fault.unit} is not isolated"
    requests = zip(record.request_ticks, record.request_coils, strict=True)
    of_sensor = not all(other.unit.startswith("coil ") for other in row.faults)
    end = _doubted(record.onset or 0, record) if of_sensor else inf
    seen = ((tick, coil) for tick, coil in requests if onset <= tick < end and record.lit[tick])
    count = sum(f"coil {coil}" == fault.unit for _, coil in seen)
    said = f"{fault.unit} is not isolated in {count} pulses of its own"
    return None if count < LEAST_PULSES else False, said


def board_identifies_unit(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool, str]:
    """The coil driver board identifies the coil by its read-back, or itself for a current without a command.

    That current may cancel the one of a pulse in which it begins, so that the coil of the pulse has none.
    """
    unit = "coil driver" if "stuck" in row.expect else row.unit
    onset = record.onset or 0
    units = [(tick, found) for tick, found in board_identifications(record) if tick >= onset]
    if unit == "coil driver":
        units = [one for one in units if one[1] == unit or one[0] > onset + PULSE_S * record.tick_hz]
    if not units:
        return False, f"the board does not identify {unit}"
    tick, first = units[0]
    return first == unit, f"board identifies {first} after {(tick - onset) / record.tick_hz:.0f} s"


def monitor_trips_for_silent_board(
    row: FaultRow, record: FaultFlightRecord, bounds: Bounds
) -> tuple[bool, str]:
    """The monitor of the silent board trips, and no other."""
    onset = record.onset or 0
    units = [unit for tick, unit in monitor_trips(record) if tick >= onset]
    return set(units) == {row.unit}, f"tripped for {', '.join(units) or 'nothing'}"


def enters_safe(row: FaultRow, record: FaultFlightRecord, bounds: Bounds) -> tuple[bool | None, str]:
    """SAFE is entered if a driver is stuck on."""
    if not can_isolate(row.unit):
        return None, "fsw cannot detect a driver that is stuck on yet"
    onset = record.onset or 0
    safe = [tick for tick in range(onset, record.ticks) if record.modes[tick] is Mode.SAFE]
    return bool(safe), f"SAFE after {(safe[0] - onset) / record.tick_hz:.0f} s" if safe else "no SAFE"
