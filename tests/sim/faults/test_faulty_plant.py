"""A plant with faults: when each begins and ends, and which frames pass through it."""

from random import Random

import pytest

from fsw.wire.messages import CoilFire, Sync
from sim.faults.fault import Fault
from sim.faults.faulty_plant import FaultyPlant, ScheduledFault
from sim.plant.coil_drive import CoilDrive
from sim.scenario.assemble import plant_config
from sim.scenario.schema import load

CONFIG = plant_config(load("microsat"), 1)
FIRE = CoilFire(3, 1, 1, 0, 3000).encode()
STRANGE = CoilFire(-1, 2, 9, 0, 500).encode()


class Noted(Fault):
    """Notes what is called and when."""

    def __init__(self, notes, name="fault"):
        super().__init__(Random(1), {})
        self.notes, self.name = notes, name

    def begin(self, plant):
        self.notes.append((plant.tick, self.name, "begins"))

    def end(self, plant):
        self.notes.append((plant.tick, self.name, "ends"))

    def before(self, tick, plant):
        self.notes.append((tick, self.name, "before"))


class Factor(Fault):
    """Multiplies all that passes, and adds one: two of them do not commute."""

    def __init__(self, factor):
        super().__init__(Random(1), {})
        self.factor = factor

    def _of(self, v):
        return (self.factor * v[0] + 1.0, v[1], self.factor * v[2])

    def field(self, b_body_t, valid):
        return self._of(b_body_t), not valid

    def sun(self, sun_body, valid):
        return self._of(sun_body), not valid

    def cells(self, currents):
        return self._of(currents)

    def coil_drive(self, drive):
        return CoilDrive(self._of(drive.current_a), drive.fraction, drive.held_a)


class Stranger(Fault):
    """Sends a frame, and loses the answer of the flight software, but not its own."""

    def strangers(self, tick):
        return [STRANGE]

    def to_boards(self, tick, frames):
        return [frame for frame in frames if frame != FIRE]


def fly(plant, ticks, answer=()):
    heard, received = [], []
    for _ in range(ticks):
        heard.append(plant.begin_tick())
        for frame in answer:
            plant.receive(frame)
        plant.end_tick()
        received.append(plant.received)
    return heard, received


def test_a_fault_is_active_from_its_first_tick_to_before_its_end():
    notes = []
    plant = FaultyPlant(CONFIG, [ScheduledFault(Noted(notes), 2, 4)])
    fly(plant, 7)
    assert notes == [
        (2, "fault", "begins"),
        (2, "fault", "before"),
        (3, "fault", "before"),
        (4, "fault", "ends"),
    ]
    assert plant.active == ()


def test_one_that_begins_when_another_ends_comes_after_it():
    notes = []
    first, second = (Noted(notes, name) for name in ("first", "second"))
    plant = FaultyPlant(CONFIG, [ScheduledFault(first, 0, 2)])
    plant.inject(ScheduledFault(second, 2, None))
    fly(plant, 3)
    assert notes[-3:] == [(2, "first", "ends"), (2, "second", "begins"), (2, "second", "before")]
    assert plant.active == (second,)


@pytest.mark.parametrize("channel", ["field", "sun"])
def test_several_act_on_a_reading_in_the_order_in_which_they_began(channel):
    plant = FaultyPlant(CONFIG, [ScheduledFault(Factor(5.0), 1), ScheduledFault(Factor(3.0), 0)])
    fly(plant, 2)
    read, valid = getattr(plant.interference, channel)((2.0, 7.0, 1.0), False)
    assert read == (5.0 * (3.0 * 2.0 + 1.0) + 1.0, 7.0, 15.0)
    assert valid is False


def test_they_act_on_cells_and_coils_too():
    plant = FaultyPlant(CONFIG, [ScheduledFault(Factor(5.0), 1), ScheduledFault(Factor(3.0), 0)])
    fly(plant, 2)
    assert plant.interference.cells((2.0, 7.0, 1.0)) == (36.0, 7.0, 15.0)
    drive = plant.interference.coil_drive(CoilDrive((2.0, 7.0, 1.0), 0.5, (0.0, 4.0, 0.0)))
    assert drive == CoilDrive((36.0, 7.0, 15.0), 0.5, (0.0, 4.0, 0.0))


def test_the_frame_of_a_stranger_reaches_fsw_before_sync_and_the_boards_with_the_answer():
    plant = FaultyPlant(CONFIG, [ScheduledFault(Stranger(Random(1), {}), 1, 2)])
    heard, received = fly(plant, 3, answer=[FIRE])
    assert [frames.count(STRANGE) for frames in heard] == [0, 1, 0]
    assert heard[1][-2] == STRANGE
    assert Sync.decode(heard[1][-1].data).tick == 1
    assert received == [[FIRE], [STRANGE], [FIRE]]
    assert STRANGE not in plant.sent
