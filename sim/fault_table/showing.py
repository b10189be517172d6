"""Where a fault shows: what the flight software has no means to see it need not report."""

from math import inf

from sim.fault_rig.record import FaultFlightRecord
from sim.fault_table.row import RowFault
from sim.faults.kinds import KINDS


def onset_tick(fault: RowFault, record: FaultFlightRecord) -> int:
    """The tick in which a fault of the row begins."""
    return (record.onset or 0) + round(fault.after_s * record.tick_hz)


def shows(fault: RowFault, record: FaultFlightRecord) -> bool:
    """Whether the flight has a tick in which a fault can be seen: by its kind in sunlight, shadow or both."""
    first = onset_tick(fault, record)
    end = len(record.lit) if fault.lasts_s == inf else first + round(fault.lasts_s * record.tick_hz)
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
