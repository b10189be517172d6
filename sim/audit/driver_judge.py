"""Whether a board reports what its kind of driver drives, and what a continuous one has driven.

A pulsed driver drives levels, which COIL_STATUS reports; a continuous one drives fractions of its full scale,
which COIL_DIPOLE_STATUS reports. What the other kind would drive, a board must never report.
"""

from collections.abc import Iterator

from fsw.wire.messages import CoilDipoleStatus, CoilStatus, intact
from sim.audit.findings import COILS, DipoleCount
from sim.record.candump import LogEntry


class DriverJudge:
    """Counts COIL_DIPOLE_STATUS, and describes each stretch of statuses that are of the other driver."""

    def __init__(self, continuous: bool) -> None:
        self._continuous = continuous
        self._statuses = self._any = self._broken = 0
        self._driven = [0, 0, 0]
        self._is_off = False
        self._found: list[tuple[int, str]] = []

    @property
    def count(self) -> DipoleCount | None:
        """What a continuous driver has driven; None of a pulsed one."""
        if not self._continuous:
            return None
        return DipoleCount(self._statuses, (self._driven[0], self._driven[1], self._driven[2]), self._any)

    def take_dipole(self, entry: LogEntry) -> bool:
        """The next COIL_DIPOLE_STATUS of the log; False if it is broken."""
        if not intact(entry.frame):
            self._broken += 1
            return False
        status = CoilDipoleStatus.decode(entry.frame.data)
        fractions = (status.m_x, status.m_y, status.m_z)
        self._statuses += 1
        self._any += any(fractions)
        for coil in COILS:
            self._driven[coil] += bool(fractions[coil])
        if not self._continuous:
            text = ", ".join(f"{fraction:g}" for fraction in fractions)
            self._take(any(fractions), entry.line, f"a pulsed driver reports {text} of full scale as driven")
        return True

    def take_level(self, line: int, status: CoilStatus) -> None:
        """The next COIL_STATUS of the log."""
        if self._continuous:
            sentence = f"a continuous driver reports level {status.level} of coil {status.coil}"
            self._take(bool(status.level), line, sentence)

    def notes(self, statuses: int) -> Iterator[str]:
        """What a reader must know, a sentence each, of a log with so many COIL_STATUS."""
        if self._continuous and not self._statuses:
            yield "no COIL_DIPOLE_STATUS in the log: nothing to judge"
        elif not statuses:
            yield "no COIL_STATUS in the log: nothing to judge"
        elif self._continuous and self._statuses != statuses:
            yield f"{self._statuses} COIL_DIPOLE_STATUS to {statuses} COIL_STATUS: one of each a tick is due"
        if self._broken:
            yield f"{self._broken} COIL_DIPOLE_STATUS with a wrong CRC or length"

    def found(self) -> list[tuple[int, str]]:
        """The stretches that have begun since the last call: line and sentence."""
        found, self._found = self._found, []
        return found

    def _take(self, is_off: bool, line: int, sentence: str) -> None:
        if is_off and not self._is_off:
            self._found.append((line, sentence))
        self._is_off = is_off
