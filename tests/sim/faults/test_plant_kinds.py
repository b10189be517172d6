"""Faults of sensors, coils and boards: their effect on frames and currents."""

from itertools import pairwise
from math import inf, isnan, radians
from random import Random
from types import SimpleNamespace

import pytest

from fsw.wire.messages import (
    CoilBoot,
    CoilFire,
    CoilStatus,
    MagBoot,
    MagField,
    SunBoot,
    SunCells,
    SunVector,
    WheelBoot,
)
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.faults.kinds import make
from sim.faults.node_kinds import count_doubles, flip, flip_bit
from sim.plant.coil_drive import CoilDrive
from sim.plant.config import CoilConfig, MagnetometerConfig
from sim.plant.hardware.coils import Coils
from sim.plant.hardware.sensors import MagnetometerPhysics
from sim.plant.rotation import ZERO
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

B_T = (20e-6, -7e-6, 31e-6)
SUN = (0.6, -0.64, 0.48)


def fault(kind, **parameters):
    return make(kind, parameters, Random(1))


@pytest.mark.parametrize(
    ("kind", "parameters", "read_t"),
    [
        ("mag_saturated", {"nt": 15000.0}, (15e-6, -7e-6, 15e-6)),
        ("mag_bias", {"axis": 1.0, "nt": 4000.0}, (20e-6, -3e-6, 31e-6)),
        ("mag_scale", {"axis": 2.0, "scale": -1.0}, (20e-6, -7e-6, -31e-6)),
        ("mag_swapped", {"axis": 0.0}, (-7e-6, 20e-6, 31e-6)),
        ("mag_swapped", {"axis": 2.0}, (31e-6, -7e-6, 20e-6)),
        ("mag_infinite", {"axis": 1.0}, (20e-6, inf, 31e-6)),
        ("mag_turned", {"axis": 0.0, "deg": 90.0}, (20e-6, 31e-6, 7e-6)),
        ("mag_turned", {"axis": 1.0, "deg": 90.0}, (-31e-6, -7e-6, 20e-6)),
    ],
)
def test_the_magnetometer_reads_wrong_and_calls_it_valid(kind, parameters, read_t):
    read, valid = fault(kind, **parameters).field(B_T, True)
    assert read == pytest.approx(read_t)
    assert valid


def test_a_turned_sensor_reads_as_one_that_is_misaligned_by_the_same_angle():
    config = MagnetometerConfig(misalignment_rad=(0.0, 0.0, radians(25.0)))
    misaligned, _ = MagnetometerPhysics(config, seed=1).measure(B_T, ZERO)
    turned, _ = fault("mag_turned", axis=2.0, deg=25.0).field(B_T, True)
    assert turned == pytest.approx(misaligned)


class Clock:
    """What a fault needs of a plant to know the time."""

    t_s = 0.0


def changed(kind, read, after_s, **parameters):
    """The reading of a fault that began ``after_s`` ago, at 700 s."""
    wrong, clock = fault(kind, **parameters), Clock()
    clock.t_s = 700.0
    wrong.begin(clock)
    clock.t_s += after_s
    wrong.before(0, clock)
    return getattr(wrong, read)(SUN if read == "sun" else B_T, True)[0]


@pytest.mark.parametrize(
    ("kind", "parameters", "after_s", "reading"),
    [
        ("mag_bias", {"axis": 1.0, "nt": 0.0, "per_s": 0.2}, 0.0, B_T),
        ("mag_bias", {"axis": 1.0, "nt": 100.0, "per_s": 0.2}, 4000.0, (20e-6, -6.1e-6, 31e-6)),
        ("mag_scale", {"axis": 2.0, "scale": 1.0, "per_s": 5e-5}, 6000.0, (20e-6, -7e-6, 40.3e-6)),
        ("mag_turned", {"axis": 0.0, "deg": 60.0, "per_s": 5e-3}, 6000.0, (20e-6, 31e-6, 7e-6)),
        ("sun_scale", {"axis": 0.0, "scale": 1.0, "per_s": -0.01}, 50.0, (0.3, -0.64, 0.48)),
        ("sun_turned", {"axis": 2.0, "deg": 0.0, "per_s": 0.1}, 900.0, (-0.64, -0.6, 0.48)),
    ],
)
def test_a_fault_that_changes_is_counted_from_its_onset(kind, parameters, after_s, reading):
    read = "sun" if kind.startswith("sun") else "field"
    assert changed(kind, read, after_s, **parameters) == pytest.approx(reading)


def test_a_turned_sun_sensor_has_no_sun_where_there_is_none():
    assert fault("sun_turned", deg=10.0).sun((0.0, 0.0, 0.0), False) == ((0.0, 0.0, 0.0), False)


def test_not_a_number_is_none():
    assert isnan(fault("mag_nan").field(B_T, True)[0][0])


def test_a_frozen_sensor_shows_its_first_value_for_ever():
    for frozen, read in ((fault("mag_frozen"), "field"), (fault("sun_frozen"), "sun")):
        first = getattr(frozen, read)(SUN, True)
        assert getattr(frozen, read)((1.0, 0.0, 0.0), False) == first == (SUN, True)


def test_the_sun_is_read_wrong_only_where_it_is_seen():
    wrong = fault("sun_scale", axis=0.0, scale=-1.0)
    assert wrong.sun(SUN, True) == ((-0.6, -0.64, 0.48), True)
    assert wrong.sun((0.0, 0.0, 0.0), False) == ((0.0, 0.0, 0.0), False)
    assert fault("sun_unseen").sun(SUN, True)[1] is False


def test_extreme_codes_are_whole_frames_of_the_sensors_alone():
    frames = [MagField(1, 1.0, 2.0, 3.0, 7).encode(), CoilStatus(0, 1, 0, 0, 0, 0, 7).encode()]
    field, status = fault("extreme_codes").from_boards(0, frames)
    decoded = MagField.decode(field.data)
    assert {abs(decoded.b_x), abs(decoded.b_y), abs(decoded.b_z)} == {65534.0}
    assert (decoded.valid, decoded.counter) == (1, 7)
    assert status == frames[1]


def test_extreme_codes_of_cells_are_whole_frames_too():
    frame = SunCells(1, 0.5, 0.25, 0.0, 1.0, 0.125, 1.5, 7).encode()
    extreme = fault("extreme_codes", sun=1.0)
    found = [SunCells.decode(extreme.from_boards(tick, [frame])[0].data) for tick in range(20)]
    assert {current for one in found for current in one.values()[1:7]} == {0.0, 255.0 / 128.0}
    assert {(one.valid, one.counter) for one in found} == {(1, 7)}
    assert fault("extreme_codes").from_boards(0, [frame]) == [frame], "of the magnetometer alone"


def test_coils_that_are_cut_or_stuck():
    coil_drive = CoilDrive((0.0, 0.1, 0.0), 0.5)
    assert fault("coil_open", axis=1.0).coil_drive(coil_drive) == CoilDrive((0.0, 0.0, 0.0), 0.5)
    assert fault("coil_open", axis=0.0).coil_drive(coil_drive) == coil_drive
    stuck = fault("coil_stuck_on", axis=2.0, ampere=0.4).coil_drive(coil_drive)
    assert stuck == CoilDrive((0.0, 0.1, 0.4), 0.5, (0.0, 0.0, 0.4))
    assert fault("coil_open", axis=2.0).coil_drive(stuck) == coil_drive


@pytest.mark.parametrize(
    ("commanded", "fraction"),
    [((0.1, -0.05, 0.2), 0.8), ((0.0, 0.1, 0.0), 0.5), ((0.0, 0.1, 0.0), 1.0), ((0.0, 0.0, 0.0), 0.0)],
)
@pytest.mark.parametrize("substeps", [1, 4])
def test_a_coil_that_is_stuck_on_lengthens_no_other(commanded, fraction, substeps):
    """Over a tick of 1 s with the coil x stuck; a current without lag, so that its mean is its share."""
    coils = Coils(CoilConfig((1.0, 2.0, 4.0), dipole_per_ampere_am2=1.0, time_constant_s=0.0))
    stuck = fault("coil_stuck_on", axis=0.0, ampere=-0.4).coil_drive(CoilDrive(commanded, fraction))
    ends = [min(max(fraction * substeps - substep, 0.0), 1.0) / substeps for substep in range(substeps)]
    steps = [coils.advance(stuck.current_a, on_s, 1.0 / substeps, stuck.held_a) for on_s in ends]
    mean = [sum(axis) / substeps for axis in zip(*steps, strict=True)]
    assert mean == pytest.approx([-0.4, commanded[1] * fraction, commanded[2] * fraction])


class Bench:
    """A plant whose coil driver is asked by hand."""

    def __init__(self, *scheduled):
        self.plant = FaultyPlant(plant_config(load("microsat"), 1), scheduled)
        self.said = []

    def fly(self, ticks, fire_at=None):
        for _ in range(ticks):
            self.said.append(self.plant.begin_tick())
            if self.plant.tick == fire_at:
                self.plant.receive(CoilFire(3, 1, 1, fire_at & 0xFF, 3000).encode())
            self.plant.end_tick()
        return self.plant.truth().m_body_am2


def test_a_coil_wired_the_wrong_way_round_gives_the_opposite_dipole_for_the_same_current():
    wrong = Bench(ScheduledFault(fault("coil_wired", axis=1.0, scale=-1.0), 0))
    right = Bench()
    m_wrong, m_right = (bench.fly(102, fire_at=100) for bench in (wrong, right))
    assert m_right[1] == pytest.approx(8.0, rel=0.02)
    assert m_wrong[1] == -m_right[1]
    currents = [
        next(CoilStatus.decode(f.data).current_ma for f in bench.said[101] if f.can_id == CoilStatus.ID)
        for bench in (wrong, right)
    ]
    assert currents[0] == currents[1] == 400


def test_a_coil_that_is_wired_wrong_twice_keeps_what_has_not_ended():
    coils = Coils(CoilConfig((1.0, 2.0, 4.0), dipole_scale=(1.0, 0.9, 1.0)))
    nominal = coils.advance((0.0, 0.1, 0.0), 1.0, 1.0)[1]
    plant = SimpleNamespace(scale_coil=coils.rescale, unscale_coil=coils.restore)
    halved, reversed_ = fault("coil_wired", axis=1.0, scale=0.5), fault("coil_wired", axis=1.0, scale=-1.0)
    dipoles = []
    for change in (halved.begin, reversed_.begin, halved.end, halved.begin, reversed_.end, halved.end):
        change(plant)
        coils.advance((0.0, 0.0, 0.0), 0.0, 1.0)
        dipoles.append(coils.advance((0.0, 0.1, 0.0), 1.0, 1.0)[1] / nominal)
    assert dipoles == pytest.approx([0.5, -0.5, -1.0, -0.5, 0.5, 1.0], rel=0.02)


def test_all_boards_are_power_cycled_the_wheel_s_too():
    plant = FaultyPlant(plant_config(load("microsat-wheel"), 1), [ScheduledFault(fault("all_restart"), 3, 5)])
    boots = []
    for _ in range(8):
        boots.append(
            {frame.can_id for frame in plant.begin_tick()}
            & {MagBoot.ID, SunBoot.ID, CoilBoot.ID, WheelBoot.ID}
        )
        plant.end_tick()
    assert boots[5] == boots[0] == {MagBoot.ID, SunBoot.ID, CoilBoot.ID, WheelBoot.ID}
    assert not any(boots[1:5] + boots[6:])


def test_a_coil_driver_that_restarts_in_a_pulse_ends_it_and_locks_out():
    bench = Bench(ScheduledFault(fault("coil_board_restarts"), 101, 102))
    bench.fly(103, fire_at=100)
    assert any(frame.can_id == CoilBoot.ID for frame in bench.said[101])
    status = next(CoilStatus.decode(f.data) for f in bench.said[102] if f.can_id == CoilStatus.ID)
    assert (status.level, status.remaining_ms, status.lockout_ms) == (0, 0, 99_000)


def test_a_dead_coil_driver_says_and_drives_nothing_and_boots_afterwards():
    bench = Bench(ScheduledFault(fault("coil_board_dead"), 101, 105))
    bench.fly(104, fire_at=100)
    silent = [frame.can_id for frames in bench.said[101:104] for frame in frames]
    assert CoilStatus.ID not in silent
    assert MagField.ID in silent
    assert not any(bench.plant.coil_drive.current_a)
    bench.fly(2)
    assert any(frame.can_id == CoilBoot.ID for frame in bench.said[105])


def test_albedo_pulls_the_sun_towards_the_earth():
    bench = Bench(ScheduledFault(fault("albedo", part=0.4), 1))
    bench.fly(2)
    clear, pulled = (
        next(SunVector.decode(f.data) for f in frames if f.can_id == SunVector.ID) for frames in bench.said
    )
    cosine = clear.s_x * pulled.s_x + clear.s_y * pulled.s_y + clear.s_z * pulled.s_z
    assert 0.2 < cosine < 0.98


def test_one_bit_of_one_double_flips():
    assert flip_bit(1.0, 63) == -1.0
    assert flip_bit(flip_bit(0.1, 17), 17) == 0.1
    state = ((1, 2.0), "x", (3.0, (4.0, 5)))
    assert count_doubles(state) == 3
    assert flip(state, 2, 63) == ((1, 2.0), "x", (3.0, (-4.0, 5)))


def test_every_double_of_a_flight_state_can_be_reached(rig):
    bench = rig()
    for _ in range(60):
        bench.tick()
    state = bench._node.state
    places = count_doubles(state)
    assert places > 100
    for place in range(0, places, 7):
        assert count_doubles(flip(state, place, 3)) == places


def test_a_storm_restarts_a_board_over_and_over_and_nothing_flows():
    bench = Bench(ScheduledFault(fault("coil_board_storm", ticks=60.0), 10, 400))
    for start in range(0, 400, 40):
        bench.fly(40, fire_at=start + 20)
    boots = [
        tick for tick, frames in enumerate(bench.said) for frame in frames if frame.can_id == CoilBoot.ID
    ]
    assert len(boots) > 6
    assert max(later - sooner for sooner, later in pairwise(boots[1:])) <= 60
    assert not any(bench.plant.coil_drive.current_a)
