"""A message of each kind that the controller listens to, and the gate that admits it."""

from copy import deepcopy

import pytest

from fsw.core.gate.calibration import NO_CALIBRATION, measure
from fsw.core.gate.readings import GateState, Readings, admit
from fsw.wire.frame import Frame
from fsw.wire.messages import (
    CoilBoot,
    CoilDipoleStatus,
    CoilRefused,
    CoilStatus,
    MagField,
    PlantEnd,
    RefAttitude,
    RefRate,
    SunCells,
    SunVector,
    WheelStatus,
)

FIELD = MagField(1, 20000.0, -7000.0, 31000.0, counter=5)
SUN = SunVector(1, 0.599975586, -0.47998046875, 0.64001464, counter=6)
COIL = CoilStatus(-2, 1, 2000, -150, 103000, 9, counter=7)
REFUSED = CoilRefused(2, 9, 8, 0xC3, counter=8)
ATTITUDE = RefAttitude(1, 0.5, -0.25, 0.125, counter=9)
RATE = RefRate(1, 2.0**-7, -(2.0**-8), 2.0**-9, counter=10)
DIPOLE = CoilDipoleStatus(0.5, -0.25, 2.0**-16, counter=11)
BOOT = CoilBoot(1, 1, 0x89ABCDEF, counter=12)
COUNTED = (FIELD, SUN, COIL, REFUSED, ATTITUDE, RATE, DIPOLE)
END = PlantEnd(9000, counter=13)
CELLS = SunCells(1, 0.5, 0.25, 1.125, 0.0078125, 1.9921875, 0.75, counter=14)
WHEEL = WheelStatus(1, 1, -312.5, 0.001953125, counter=15)
EVERY_KIND = (*COUNTED, BOOT, END, CELLS, WHEEL)
SLOT = {message.ID: slot for slot, message in enumerate(EVERY_KIND)}
KINDS = Readings.FIELDS[: len(EVERY_KIND)]
"""Their names, in the same order."""
EVERY_MESSAGE = pytest.mark.parametrize("message", EVERY_KIND, ids=lambda m: type(m).__name__)
EVERY_COUNTED = pytest.mark.parametrize("message", COUNTED, ids=lambda m: type(m).__name__)


def frames(*messages):
    return tuple(message.encode() for message in messages)


def admitted(*messages, state=None, skipped=False):
    """The messages that came through, and the state after them; the one before stays as it was."""
    raw = tuple(m if isinstance(m, Frame) else m.encode() for m in messages)
    after = deepcopy(state or GateState())
    return admit(raw, after, skipped), after


def measured(calibration=NO_CALIBRATION, **given):
    """What a tick shows in which these messages came, by kind; of the measurements, the others as given."""
    sent = {name: given.pop(name) for name in Readings.FIELDS if name in given}
    measurements = measure(Readings(**sent), calibration)
    for name, value in given.items():
        assert hasattr(measurements, name)
        setattr(measurements, name, value)
    return measurements


def taken(readings):
    """The last that came of each kind, in the order of ``EVERY_KIND``."""
    each = (getattr(readings, kind) for kind in KINDS)
    return tuple(((None, *kind)[-1] if isinstance(kind, tuple) else kind) for kind in each)


def broken(frame):
    return frame.replace(data=bytes((frame.data[0] ^ 0x20,)) + frame.data[1:])
