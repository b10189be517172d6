"""Faults of whole boards, and of the Sun sensor's view: what is silent, what boots, what goes on."""

from math import hypot
from random import Random
from types import SimpleNamespace

import pytest

from fsw.core.algebra.quaternion import rotate
from fsw.wire.messages import SENDERS, CoilBoot, MagBoot, MagField, SunBoot, SunVector
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.faults.kinds import make
from sim.plant.coil_drive import CoilDrive
from sim.plant.rotation import ZERO
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

BOOTS = {"mag": MagBoot.ID, "sun": SunBoot.ID, "coil": CoilBoot.ID}
DRIVE = CoilDrive((0.3, -0.1, 0.2), 0.5, (0.0, 0.4, 0.0))
SUN = (0.6, -0.64, 0.48)
Q = (0.8, 0.36, -0.288, 0.384)


def fault(kind, **parameters):
    return make(kind, parameters, Random(1))


def ids_of(kind, ticks, first, end):
    """The identifiers on the bus, tick by tick."""
    plant = FaultyPlant(plant_config(load("microsat"), 1), [ScheduledFault(fault(kind), first, end)])
    seen = []
    for _ in range(ticks):
        seen.append({frame.can_id for frame in plant.begin_tick()})
        plant.end_tick()
    return seen


@pytest.mark.parametrize("board", BOOTS)
def test_a_dead_board_alone_is_silent_and_alone_boots_afterwards(board):
    seen = ids_of(f"{board}_board_dead", 6, 2, 4)
    senders = [{SENDERS[can_id] for can_id in ids} for ids in seen]
    for tick in range(6):
        silent = {board.upper()} if tick in (2, 3) else set()
        assert senders[tick] == {"MAG", "SUN", "COIL", "PLANT"} - silent
    assert [seen[tick] & set(BOOTS.values()) for tick in range(1, 6)] == [
        *[set()] * 3,
        {BOOTS[board]},
        set(),
    ]


@pytest.mark.parametrize("board", BOOTS)
def test_a_board_that_restarts_boots_alone_and_once(board):
    seen = ids_of(f"{board}_board_restarts", 6, 2, 5)
    assert [ids & set(BOOTS.values()) for ids in seen[1:]] == [set(), {BOOTS[board]}, *[set()] * 3]


@pytest.mark.parametrize(("board", "drive"), [("mag", DRIVE), ("sun", DRIVE), ("coil", CoilDrive(ZERO, 0.0))])
def test_only_without_its_driver_a_coil_is_without_current(board, drive):
    assert fault(f"{board}_board_dead").coil_drive(DRIVE) == drive


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_no_current_flows_in_a_coil_that_is_cut_not_even_where_its_switch_is_stuck(axis):
    cut = fault("coil_open", axis=float(axis)).coil_drive(CoilDrive((0.3, -0.1, 0.2), 0.5, (0.4, 0.4, 0.4)))
    for current in (cut.current_a, cut.held_a):
        assert [i for i in range(3) if current[i] == 0.0] == [axis]
    assert cut.fraction == 0.5


def deflected(part, sun, valid):
    albedo = fault("albedo", part=part)
    albedo.begin(SimpleNamespace(truth=lambda: SimpleNamespace(q_body_from_orbit=Q)))
    return albedo.sun(sun, valid)


@pytest.mark.parametrize("part", [0.0, 0.25, 1.0])
def test_albedo_reads_between_sun_and_earth_and_without_sun_the_earth(part):
    down = rotate(Q, (-1.0, 0.0, 0.0))
    between = [(1.0 - part) * s + part * e for s, e in zip(SUN, down, strict=True)]
    read, valid = deflected(part, SUN, valid=True)
    assert read == pytest.approx([component / hypot(*between) for component in between])
    assert hypot(*read) == pytest.approx(1.0)
    assert valid
    read, valid = deflected(part, ZERO, valid=False)
    assert read == pytest.approx(down)
    assert valid


def test_a_sun_sensor_that_freezes_in_the_dark_reads_a_direction():
    frozen = fault("sun_frozen")
    read, valid = frozen.sun(ZERO, False)
    assert (hypot(*read), valid) == (1.0, True)
    assert frozen.sun(SUN, True) == (read, True)


@pytest.mark.parametrize("kind", ["mag_bias", "mag_scale", "mag_turned", "mag_swapped", "mag_saturated"])
def test_a_wrong_field_that_is_not_valid_does_not_become_valid(kind):
    assert fault(kind).field((2e-5, -7e-6, 3e-5), False)[1] is False


def test_an_unseen_sun_is_no_direction():
    assert fault("sun_unseen").sun(SUN, True) == (ZERO, False)


@pytest.mark.parametrize("sun", [0.0, 1.0])
def test_extreme_codes_are_of_the_named_sensor_and_of_either_sign_on_each_axis(sun):
    field, direction = MagField(1, 1.0, 2.0, 3.0, 7), SunVector(1, 0.6, -0.64, 0.48, 9)
    extreme, changed, kept = fault("extreme_codes", sun=sun), (field, direction)[round(sun)], []
    signs = [set(), set(), set()]
    for tick in range(60):
        frames = extreme.from_boards(tick, [field.encode(), direction.encode()])
        wrong = type(changed).decode(frames[round(sun)].data)
        kept.append(frames[1 - round(sun)])
        assert (wrong.valid, wrong.counter) == (1, changed.counter)
        for axis in range(3):
            signs[axis].add(wrong.values()[1 + axis] > 0.0)
            assert abs(wrong.values()[1 + axis]) == pytest.approx((65534.0, 1.9999)[round(sun)], rel=1e-4)
    assert signs == [{True, False}] * 3
    assert set(kept) == {(direction, field)[round(sun)].encode()}
