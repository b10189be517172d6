"""Telecommands of a scenario: sent in their tick, answered, and replayed from the log to the last bit."""

import re
import tomllib
from decimal import Decimal
from math import dist
from pathlib import Path
from random import Random

import pytest

from fsw.core.laws.table import LAWS, OWN_NUMBER
from fsw.core.orbit.elements import RANGES, Elements
from fsw.core.orbit.propagation import element_orbit, sgp4_orbit, state_eci
from fsw.core.packing import copy_state
from fsw.input.schema import TableError
from fsw.node import FlightNode
from fsw.table.config import flight_config
from fsw.wire.candump_line import format_line, format_time
from fsw.wire.messages import (
    CLASSES,
    NAMES,
    SENDERS,
    Component,
    Element,
    Gain,
    Mode,
    Sync,
    TcAck,
    TcAckResult,
    TcClear,
    TcFreeze,
    TcGain,
    TcLaw,
    TcMode,
    TcOrbitElement,
    TcOrbitLoad,
    TcParameter,
    TcSpin,
    TickDone,
    intact,
)
from sim.flight.record_flight import record_flight
from sim.flight.virtual import fly_virtual
from sim.flight.virtual_bus import VirtualBus
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.pace import Pace
from sim.record.run_dir import BUS_LOG
from sim.replay.log_replay import replay
from sim.scenario.schema import flight_table, load
from sim.scenario.telecommands import SendLaw, digits_of, elements_of, unsent_telecommands, uplink

ITAMSAT = (
    "1 22826U 93061D   15086.11593543  .00000251  00000-0  11414-3 0  9992",
    "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
)
TICKS = 260
SENT = [
    {"at_s": 200.0, "message": "TC_MODE", "mode": "DETUMBLE"},
    {"at_s": 60.0, "message": "TC_LAW", "law": "bdot"},
    {"at_s": 60.5, "message": "TC_SPIN", "spin_radps": 0.0078125},
    {"at_s": 60.5, "message": "TC_GAIN", "gain": "k_w", "value": 5.5e6},
    {"at_s": 120.0, "message": "TC_ORBIT_LOAD", "tle": list(ITAMSAT)},
    {"at_s": 130.0, "message": "TC_SPIN", "spin_radps": 0.12},
    {"at_s": 140.0, "message": "TC_LAW", "law": "predictive"},
    {"at_s": 141.0, "message": "TC_CLEAR"},
    {"at_s": 150.0, "message": "TC_PARAMETER", "component": "torque_y", "value": -2.5e-8},
    {"at_s": 150.0, "message": "TC_FREEZE", "frozen": True},
    {"at_s": 250.0, "message": "TC_FREEZE", "frozen": False},
]


def with_telecommands(*sent, **changes):
    return load("microsat", {"telecommand": list(sent), **changes})


def sent_by(*sent, tick_hz=1, ticks=range(400)):
    """The messages of each tick that has some."""
    frames_of = uplink(with_telecommands(*sent).telecommand, tick_hz)
    told = {tick: [CLASSES[f.can_id].decode(f.data) for f in frames_of(tick)] for tick in ticks}
    return {tick: messages for tick, messages in told.items() if messages}


class TestSchedule:
    def test_each_goes_out_in_the_first_tick_at_or_after_its_time_as_what_it_says(self):
        told = sent_by(*SENT)
        assert {tick: messages for tick, messages in told.items() if tick != 120} == {
            60: [TcLaw(LAWS["bdot"].number)],
            61: [TcSpin(0.0078125), TcGain(Gain.K_W, 5, 55)],
            130: [TcSpin.decode(TcSpin(0.12, 1).encode().data)],
            140: [TcLaw(LAWS["predictive"].number, 1)],
            141: [TcClear()],
            150: [TcParameter(Component.TORQUE_Y, -9, -25), TcFreeze(1)],
            200: [TcMode(Mode.DETUMBLE)],
            250: [TcFreeze(0, 1)],
        }

    @pytest.mark.parametrize(("tick_hz", "tick"), [(1, 2), (10, 11), (100, 110)])
    def test_by_integer_ticks(self, tick_hz, tick):
        assert [*sent_by({"at_s": 1.1, "message": "TC_CLEAR"}, tick_hz=tick_hz)] == [tick]

    def test_each_kind_counts_for_itself_and_turns_over(self):
        many = [{"at_s": float(n), "message": "TC_CLEAR"} for n in range(20)]
        told = sent_by(*many, {"at_s": 5.0, "message": "TC_MODE", "mode": "SAFE"})
        assert [messages[0].counter for messages in told.values()] == [n % 16 for n in range(20)]
        assert told[5][1] == TcMode(Mode.SAFE, 0)

    def test_all_frames_are_intact_and_the_ground_s(self):
        frames_of = uplink(with_telecommands(*SENT).telecommand, 1)
        frames = [frame for tick in range(400) for frame in frames_of(tick)]
        assert len(frames) == 10 + 10
        assert all(intact(frame) and SENDERS[frame.can_id] == "GROUND" for frame in frames)

    def test_nothing_is_sent_where_nothing_is_asked_for(self):
        assert load("microsat").telecommand == ()
        assert sent_by() == {}


class TestUnsent:
    """Telecommands that a run is too short for."""

    TIMES_S = (0.0, 59.3, 60.0, 60.01, 1e9)

    def sent_at(self, *times_s):
        return load(
            "microsat", {"telecommand": [{"at_s": at_s, "message": "TC_CLEAR"} for at_s in times_s]}
        ).telecommand

    @pytest.mark.parametrize("tick_hz", [1, 3, 10])
    @pytest.mark.parametrize("seconds", [1, 60, 61])
    def test_are_those_that_no_tick_of_the_run_sends(self, tick_hz, seconds):
        telecommands, ticks = self.sent_at(*self.TIMES_S), seconds * tick_hz
        frames = uplink(telecommands, tick_hz)
        sent = sum(len(frames(tick)) for tick in range(ticks))
        unsent = unsent_telecommands(telecommands, tick_hz, ticks)
        assert len(unsent) == len(self.TIMES_S) - sent
        assert [sentence.partition(",")[0] for sentence in unsent] == [
            f"telecommand[{place}]" for place in range(sent, len(self.TIMES_S))
        ]

    def test_are_told_with_the_end_of_the_run(self):
        (sentence,) = unsent_telecommands(self.sent_at(12.0, 600.0), 1, 500)
        assert sentence == "telecommand[1], TC_CLEAR at 600 s, will not be sent: the last tick is at 499 s"


class TestNumbers:
    @pytest.mark.parametrize(
        ("text", "wire"),
        [
            ("1614.9", (16149, -1)),
            ("6.2694e6", (62694, 2)),
            ("0", (0, 0)),
            ("-0.5", (-5, -1)),
            ("2147483647", (2147483647, 0)),
        ],
    )
    def test_are_decimal(self, text, wire):
        assert digits_of(Decimal(text)) == wire

    @pytest.mark.parametrize("text", ["2147483649", "1.23456789012", "1e130", "1e-130"])
    def test_that_do_not_fit(self, text):
        with pytest.raises(ValueError, match="does not fit"):
            digits_of(Decimal(text))

    def test_elements_are_those_of_the_two_lines(self):
        found = elements_of(*ITAMSAT)
        assert [*found] == [*Element]
        assert found[Element.EPOCH_DAY] == 16521
        assert found[Element.EPOCH_FRACTION] == Decimal("0.11593543")
        assert found[Element.BSTAR] == Decimal("0.00011414")
        assert all(low <= found[element] <= high for element, (low, high) in RANGES.items())
        lines, numbers = sgp4_orbit(*ITAMSAT), element_orbit(Elements(*map(float, found.values())))
        (r, v), (r2, v2) = state_eci(lines, 1427500000), state_eci(numbers, 1427500000)
        assert dist(r, r2) < 0.01
        assert dist(v, v2) < 1e-5

    def test_a_negative_drag_term(self):
        line1, line2 = ITAMSAT
        negative = line1.replace(" 11414-3", "-11414-3")[:-1] + "3"  # the sign counts in the checksum
        assert elements_of(negative, line2)[Element.BSTAR] == Decimal("-0.00011414")

    def test_each_element_alone(self):
        sent = {"at_s": 3.0, "message": "TC_ORBIT_ELEMENT", "element": "eccentricity", "value": 0.0008932}
        assert sent_by(sent) == {3: [TcOrbitElement(Element.ECCENTRICITY, -7, 8932)]}
        assert sent_by({"at_s": 3.0, "message": "TC_ORBIT_LOAD"}) == {3: [TcOrbitLoad()]}


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ({"at_s": -1.0}, "at_s = -1.0 is not allowed"),
        ({"spin_radps": 0.125}, "spin_radps = 0.125 is not allowed"),
        ({"spin": 0.1}, "spin is not a known key"),
        ({"message": "TC_SPAM"}, "TC_MODE, TC_CLEAR"),
        ({"message": "TC_LAW", "law": "none"}, "law = 'none' is not allowed"),
        ({"message": "TC_MODE", "mode": "safe"}, "mode = 'safe' is not allowed"),
        ({"message": "TC_GAIN", "gain": "k_w", "value": 1.23456789012}, "value: 1.23456789012 does not fit"),
        ({"message": "TC_PARAMETER", "component": "torque", "value": 1e-8}, "component = 'torque' is not"),
        ({"message": "TC_PARAMETER", "component": "torque_x", "value": 1e-150}, "value is not allowed"),
        ({"message": "TC_FREEZE", "frozen": 1}, "frozen = 1 is not allowed"),
        ({"message": "TC_ORBIT_LOAD", "tle": ["1", "2"]}, "tle: element line 1 is not"),
    ],
)
def test_what_cannot_be_sent_is_refused(wrong, told):
    with pytest.raises(TableError, match=r"scenario microsat: .*telecommand") as error:
        with_telecommands({"at_s": 1.0, "message": "TC_SPIN", "spin_radps": 0.01, **wrong})
    assert told in str(error.value)


@pytest.fixture(scope="module")
def page():
    return (Path(__file__).parents[3] / "docs" / "telecommands.md").read_text(encoding="utf-8")


class TestPage:
    """docs/telecommands.md says what is so."""

    def test_it_lists_every_telecommand_with_its_identifier(self, page):
        rows = re.findall(r"^\| `(TC_\w+)` \| (\w+) \|", page, re.MULTILINE)
        ground = {NAMES[can_id]: f"{can_id:03X}" for can_id, node in SENDERS.items() if node == "GROUND"}
        assert dict(rows) == ground

    def test_its_scenario_can_be_flown(self, page):
        (example,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
        told = sent_by(*tomllib.loads(example)["telecommand"], ticks=range(2000))
        assert {tick: len(messages) for tick, messages in told.items()} == {600: 2, 900: 1, 1200: 10, 1500: 2}

    def test_its_frame_is_what_it_says(self, page):
        (said,) = set(re.findall(r"0A3#\w+", page))
        assert said == f"0A3#{TcSpin(0.02, counter=1).encode().data.hex()}"


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A run in which the ground changes law, gain, spin, orbit and mode, and asks for a spin too fast."""
    path = tmp_path_factory.mktemp("telecommands") / "run"
    scenario = with_telecommands(*SENT, control={"law": "pd"})
    run_dir.begin(path, scenario, 5, TICKS, "virtual", Pace())
    fly_virtual(path, scenario, lambda tick: None)
    return path


@pytest.fixture(scope="module")
def entries(flown):
    return list(read_log(flown / BUS_LOG))


@pytest.fixture(scope="module")
def refly(flown, tmp_path_factory):
    """Reflies log entries with the scenario that the run directory holds."""
    config = flight_config(flight_table(run_dir.read_scenario(flown)))

    def through(entries, on_tick=lambda state: None):
        log = tmp_path_factory.mktemp("log") / BUS_LOG
        lines = [format_line(format_time(e.timestamp_us), e.channel, e.frame) for e in entries]
        log.write_text("".join(lines))
        return replay(log, config, on_tick)

    return through


class TestFlight:
    def test_each_is_answered_once_in_its_tick(self, entries):
        answered, tick, sent = [], 0, []
        for entry in entries:
            frame = entry.frame
            if SENDERS[frame.can_id] == "GROUND":
                sent.append((frame.can_id, CLASSES[frame.can_id].decode(frame.data).counter, tick))
            if frame.can_id == TcAck.ID:
                answered.append(TcAck.decode(frame.data))
            tick += frame.can_id == TickDone.ID
        assert [(ack.command, ack.command_counter, ack.tick) for ack in answered] == sent
        assert len(sent) == 10 + 10
        refused = [ack for ack in answered if ack.result != TcAckResult.ACCEPTED]
        assert [(ack.command, ack.result) for ack in refused] == [(TcSpin.ID, TcAckResult.OUT_OF_RANGE)]

    def test_it_replays_to_the_last_bit(self, entries, refly):
        states = {}
        shown = refly(entries, lambda state: states.update({state.tick: copy_state(state)}))
        assert shown.bit_exact
        assert shown.ended
        assert shown.ticks == TICKS
        laws = {tick: states[tick].setpoint.law for tick in (59, 60, 139, 140)}
        assert laws == {59: "pd", 60: "bdot", 139: "bdot", 140: "predictive"}
        assert (states[60].setpoint.spin_radps, states[259].setpoint.spin_radps) == (0.0, 0.0078125)
        assert states[259].setpoint.k_w == 5.5e6
        assert states[119].orbit is None
        assert states[120].orbit == Elements(*map(float, elements_of(*ITAMSAT).values()))
        assert states[200].modes.mode is Mode.DETUMBLE
        torques = [states[tick].estimator.estimate.parameters.torque_body_nm for tick in (149, 150, 249)]
        assert [torque[1] == -2.5e-8 for torque in torques] == [False, True, True]
        assert [states[tick].estimator.frozen for tick in (149, 150, 249, 250)] == [False, True, True, False]

    @pytest.mark.parametrize(
        "kind",
        [TcLaw, TcSpin, TcGain, TcOrbitLoad, TcMode, TcClear, TcParameter, TcFreeze],
        ids=lambda k: k.__name__,
    )
    def test_a_log_without_one_of_them_replays_no_more(self, entries, refly, kind):
        index = next(i for i, entry in enumerate(entries) if entry.frame.can_id == kind.ID)
        tick = sum(entry.frame.can_id == Sync.ID for entry in entries[:index])
        shown = refly(entries[:index] + entries[index + 1 :])
        assert not shown.command_exact
        assert shown.first_bit_difference.tick == tick
        assert "TC_ACK" in str(shown.first_bit_difference)


class RacingBus(VirtualBus):
    """A hand at another terminal: its commands meet the plant's frames of each tick, at every place."""

    def __init__(self, node):
        super().__init__(node)
        self.random, self.count = Random(3), 0

    def send(self, frames):
        places = [self.random.randrange(len(frames) + 1) for _ in range(self.random.choice([0, 0, 1, 2]))]
        for place, frame in enumerate([*frames, None]):
            for _ in range(places.count(place)):
                self.count += 1
                spin = TcSpin(self.count * 2.0**-19, counter=self.count & 0xF).encode()
                self._queue.append(spin)
                super().send([spin])
            if frame is not None:
                super().send([frame])


@pytest.mark.long
def test_commands_by_hand_replay_too_wherever_they_meet_the_tick(tmp_path):
    scenario = load("microsat", {"control": {"law": "pd"}})
    run_dir.begin(tmp_path, scenario, 5, TICKS, "virtual", Pace())
    config = flight_config(flight_table(scenario))
    bus = RacingBus(FlightNode(config))
    record_flight(tmp_path, scenario, bus)
    shown = replay(tmp_path / BUS_LOG, config)
    assert bus.count > 150
    assert shown.bit_exact, shown.first_bit_difference
    assert shown.ended


def test_the_law_of_ones_own_is_sent_by_the_last_number():
    (message,) = SendLaw(message="TC_LAW", at_s=0.0, law="own").messages()
    assert message == TcLaw(OWN_NUMBER)


@pytest.mark.parametrize(
    ("telecommand", "said"),
    [
        (
            {"at_s": 3.0, "message": "TC_SPINN"},
            r"telecommand\.0\.message = 'TC_SPINN' is not allowed: allowed is one of TC_MODE, .*TC_SPIN\b",
        ),
        (3, r"telecommand\.0 = 3 is not allowed: allowed is a section of keys"),
    ],
)
def test_what_is_no_telecommand_is_said_in_the_words_of_the_file(telecommand, said):
    with pytest.raises(TableError, match=said):
        load("microsat", {"telecommand": [telecommand]})
