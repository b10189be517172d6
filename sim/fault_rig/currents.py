"""Second audit of invariant I: of the currents that the plant drove, not of what the board reports.

It shares nothing with the auditor of COIL_STATUS: its input is neither sequence numbers nor announcements but
which current flowed in which part of which tick.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isclose

from sim.plant.coil_drive import CoilDrive

PER_TICK = 1_000_000
"""Resolution of a fraction of a tick."""


@dataclass(frozen=True, slots=True)
class CurrentLimits:
    """Limits of the currents; ``levels_a`` are the three magnitudes."""

    tick_hz: int
    levels_a: tuple[float, float, float]
    pulse_s: Fraction
    backoff_s: Fraction
    shared: bool


@dataclass(frozen=True, slots=True)
class CurrentPulse:
    """A coil through which a current flowed without a break over [start_s, end_s)."""

    coil: int
    start_s: Fraction
    end_s: Fraction


def pulses(drives: Sequence[CoilDrive], tick_hz: int) -> list[CurrentPulse]:
    """The pulses in the plant's currents, ordered by start."""
    found: list[CurrentPulse] = []
    under_way: dict[int, Fraction] = {}
    for tick, drive in enumerate(drives):
        now = Fraction(tick, tick_hz)
        for coil in range(3):
            part = Fraction(round(_share(drive, coil) * PER_TICK), PER_TICK * tick_hz)
            on = part > 0
            start = under_way.pop(coil, None)
            if start is not None and not on:
                found.append(CurrentPulse(coil, start, now))
            elif on and part * tick_hz < 1:
                found.append(CurrentPulse(coil, now if start is None else start, now + part))
            elif on:
                under_way[coil] = now if start is None else start
    last = Fraction(len(drives), tick_hz)
    found += [CurrentPulse(coil, start, last) for coil, start in under_way.items()]
    return sorted(found, key=lambda pulse: pulse.start_s)


def violations(drives: Sequence[CoilDrive], limits: CurrentLimits) -> list[str]:
    """Each breach of invariant I, a sentence each."""
    return [*_momentary(drives, limits), *lasting(pulses(drives, limits.tick_hz), limits)]


def _momentary(drives: Sequence[CoilDrive], limits: CurrentLimits) -> list[str]:
    found = []
    for tick, drive in enumerate(drives):
        flowing = [current for coil, current in enumerate(drive.current_a) if _share(drive, coil)]
        if len(flowing) > 1:
            found.append(f"tick {tick}: {len(flowing)} coils at once")
        for current in flowing:
            if not any(isclose(abs(current), level, rel_tol=1e-9) for level in limits.levels_a):
                found.append(f"tick {tick}: {current:g} A is no level")
    return found


def _share(drive: CoilDrive, coil: int) -> float:
    """The fraction of a tick in which a current flows through a coil."""
    if drive.held_a[coil]:
        return 1.0
    return drive.fraction if drive.current_a[coil] else 0.0


def lasting(found: Sequence[CurrentPulse], limits: CurrentLimits) -> list[str]:
    """A sentence for each pulse that is too long or too soon; the pulses are ordered by start."""
    sentences = [
        f"coil {pulse.coil} on for {float(pulse.end_s - pulse.start_s):g} s at {float(pulse.start_s):g} s"
        for pulse in found
        if pulse.end_s - pulse.start_s > limits.pulse_s
    ]
    ended: dict[int, Fraction] = {}
    for pulse in found:
        before = max(
            (end for coil, end in ended.items() if limits.shared or coil == pulse.coil), default=None
        )
        if before is not None and pulse.start_s - before < limits.backoff_s:
            gap = float(pulse.start_s - before)
            sentences.append(f"coil {pulse.coil} on {gap:g} s after a pulse, at {float(pulse.start_s):g} s")
        ended[pulse.coil] = max(pulse.end_s, ended.get(pulse.coil, pulse.end_s))
    return sentences
