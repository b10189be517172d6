"""Each telecommand with extreme contents, in each mode and on satellites of every kind: no exception."""

from functools import cache
from random import Random

import pytest
from flight_states import altered, stepped
from replies import of

from fsw.core.commands import LAW_NAMES
from fsw.core.events import Event
from fsw.core.fdir.faults import Sensor
from fsw.core.fdir.sensors.cells import CellWatch
from fsw.core.fdir.sensors.watch import Watch
from fsw.core.modes import ModeState
from fsw.core.orbit.elements import RANGES
from fsw.core.packing import copy_state
from fsw.core.state import Inbox
from fsw.core.step import boot
from fsw.table.config import flight_config
from fsw.wire.messages import (
    CLASSES,
    Component,
    Element,
    FswEvent,
    Gain,
    Mode,
    Sync,
    TcAck,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
)
from sim.plant.plant import Plant
from sim.scenario.assemble import plant_config
from sim.scenario.schema import flight_table, load

SATELLITES = ("microsat", "cubesat-cells", "microsat-wheel", "kalman-50kg")
"""Pulsed coils and a Sun sensor, Sun cells, a driven wheel, continuous coils."""
EVERY = pytest.mark.parametrize("name", SATELLITES)
IN_EACH = pytest.mark.parametrize("mode", Mode)
BEFORE, AFTER = 40, 3
"""Ticks flown before a telecommand and after it."""
MANTISSAS = (-(2**31), -1, 0, 1, 2**31 - 1)
EXPONENTS = (-128, -9, 0, 12, 127)
DECIMALS = [(exponent, mantissa) for exponent in EXPONENTS for mantissa in MANTISSAS]


@cache
def flown(name, knowledge="filter"):
    """The tables, the state after some ticks, and what the boards say in the ticks after it."""
    scenario = load(name, {"knowledge": knowledge})
    config = flight_config(flight_table(scenario))
    plant, state = Plant(plant_config(scenario, 5)), boot(config)
    inboxes = []
    for _ in range(BEFORE + 1 + AFTER):
        *frames, sync = plant.begin_tick()
        told = Sync.decode(sync.data)
        inboxes.append(Inbox(told.tick, told.unix_time_s, tuple(frames)))
        if len(inboxes) <= BEFORE:
            state, outbox = stepped(state, inboxes[-1], config)
            for frame in outbox:
                plant.receive(frame)
        plant.end_tick()
    return config, state, inboxes[BEFORE:]


def obey(flight, mode, *telecommands):
    """What is said: all are acknowledged, and the flight goes on for some ticks."""
    config, state, inboxes = flight
    attitude = state.attitude.replace(valid=True, usable=True)
    state = altered(state, attitude=attitude, modes=ModeState(mode, state.tick))
    sent = tuple(message.encode() for message in telecommands)
    said = []
    for inbox in (inboxes[0].replace(frames=(*sent, *inboxes[0].frames)), *inboxes[1:]):
        state, outbox = stepped(state, inbox, config)
        said += [CLASSES[frame.can_id].decode(frame.data) for frame in outbox]
    assert state.tick == inboxes[-1].tick
    assert [ack.command for ack in of(TcAck, said)] == [message.ID for message in telecommands]
    return said


@EVERY
@IN_EACH
def test_modes_clearing_spin_and_freezing(name, mode):
    for message in (
        *[TcMode(number) for number in range(16)],
        TcClear(),
        *[TcSpin(spin) for spin in (-0.1, 0.0, 0.1, -0.125, 0.125)],
        TcFreeze(0),
        TcFreeze(1),
    ):
        obey(flown(name), mode, message)


@EVERY
@IN_EACH
def test_all_in_one_tick(name, mode):
    obey(flown(name), mode, TcFreeze(1), TcSpin(0.1), TcGain(Gain.K_W, 12, 1), TcClear(), TcMode(Mode.POINT))


@EVERY
@IN_EACH
def test_gains(name, mode):
    for gain in Gain:
        for exponent, mantissa in DECIMALS:
            obey(flown(name), mode, TcGain(gain, exponent, mantissa))


def try_law(name, mode, number):
    """A law that knows the attitude, with no gain and with the largest ones."""
    for exponent, mantissa in ((0, 0), (12, 1)):
        gains = [TcGain(gain, exponent, mantissa, counter=gain) for gain in Gain]
        obey(flown(name, "perfect"), mode, *gains, TcLaw(number))


@EVERY
@IN_EACH
def test_laws(name, mode):
    """Some of them in each; all are in the long suite."""
    for number in Random(f"{name} {mode}").sample([*LAW_NAMES, 254, 255], 8):
        try_law(name, mode, number)


@pytest.mark.long
@EVERY
@IN_EACH
def test_every_law(name, mode):
    for number in [*LAW_NAMES, 254, 255]:
        try_law(name, mode, number)


@pytest.mark.parametrize("mode", Mode)
def test_clearing_reports_isolated_cells_as_readmitted(mode):
    config, state, inboxes = flown("cubesat-cells")
    health = copy_state(state.health)
    health.sensors.cells = [CellWatch(Watch(fault)) for fault in (0, 4, 0, 2, 0, 0)]
    said = obey((config, altered(state, health=health), inboxes), mode, TcClear())
    readmitted = [e.argument for e in of(FswEvent, said) if e.event == Event.SENSOR_READMITTED]
    assert readmitted == [100 * Sensor.CELL_2 + 4, 100 * Sensor.CELL_4 + 2]


@EVERY
def test_orbits(name):
    ends = [(0, 0, 0), *[(element, *DECIMALS[place]) for element in Element for place in (0, 7, 12, 24)]]
    for element, exponent, mantissa in ends:
        obey(flown(name), Mode.DETUMBLE, TcOrbitElement(element, exponent, mantissa))
    for end in (0, 1):
        sent = [TcOrbitElement(e, -6, round(1e6 * RANGES[e][end]), counter=e) for e in Element if e]
        day = TcOrbitElement(Element.EPOCH_DAY, 0, round(RANGES[Element.EPOCH_DAY][end]))
        if all(abs(message.mantissa) < 2**31 for message in sent):
            obey(flown(name), Mode.DETUMBLE, day, *sent, TcOrbitLoad())


@EVERY
@IN_EACH
def test_parameters(name, mode):
    """In one tick as many as it takes."""
    for exponent, mantissa in DECIMALS[::4]:
        every = [TcParameter(one, exponent, mantissa, counter=one & 0xF) for one in Component]
        obey(flown(name), mode, *every[:40])
