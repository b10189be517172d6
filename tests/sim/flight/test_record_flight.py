"""The length of a flight, checks before it, and the files that it leaves in its run directory."""

import hashlib
import json
from datetime import UTC, datetime
from importlib.metadata import version
from math import inf, nan

import pytest

from fsw.input.schema import TableError
from fsw.wire.frame import Frame
from fsw.wire.messages import FswBoot, TickDone
from sim.errors import FlightError, HarnessError
from sim.flight import fsw_answers
from sim.flight.record_flight import MOST_TICKS, check_can_fly, check_plant, record_flight, ticks_of
from sim.record import run_dir
from sim.record.candump import read_log
from sim.record.pace import LOCKSTEP
from sim.record.truth import TruthReader
from sim.scenario.schema import load, orbit_period_s, parse_settings

TICKS = 5
DECAYING = (
    "1 45110U 20007A   23232.80903846  .00110000  00000-0  32750-2 0    04",
    "2 45110  69.9913 111.5649 0009740 159.9373 200.0626 15.34502222    06",
)
BOOT = FswBoot(0, 1, 2).encode()


class TestLength:
    @pytest.mark.parametrize("tick_hz", [1, 3])
    def test_is_a_whole_number_of_ticks(self, tick_hz):
        scenario = load("microsat", parse_settings((f"time.tick_hz={tick_hz}",)))
        period_ticks = orbit_period_s(scenario) * tick_hz
        assert ticks_of(scenario, 2.0) == round(2.0 * period_ticks)
        assert ticks_of(scenario, None) == round(scenario.time.orbits * period_ticks)

    def test_is_at_least_one_tick(self):
        assert ticks_of(load("microsat"), 1e-9) == 1

    def test_ends_before_the_elements_have_decayed(self):
        scenario = load("microsat", {"orbit": {"tle": DECAYING}, "time": {"epoch_utc": "2023-08-21"}})
        assert ticks_of(scenario, 100.0) > 0
        with pytest.raises(
            HarnessError, match=r"scenario microsat: orbit\.tle: the elements are at .* km on 2024"
        ):
            ticks_of(scenario, 3000.0)

    @pytest.mark.parametrize("orbits", [1e5, inf, nan])
    def test_has_a_limit(self, orbits):
        with pytest.raises(HarnessError, match=rf"--orbits {orbits:g}: a run has at most {MOST_TICKS} ticks"):
            ticks_of(load("microsat", parse_settings(("time.tick_hz=10",))), orbits)

    @pytest.mark.parametrize("tick_hz", [1, 10, 100])
    def test_ends_with_the_last_number_of_a_tick(self, tick_hz):
        scenario = load("microsat", parse_settings((f"time.tick_hz={tick_hz}",)))
        orbits = MOST_TICKS / (orbit_period_s(scenario) * tick_hz)
        assert MOST_TICKS - 10 <= ticks_of(scenario, orbits * (1.0 - 1e-12)) <= MOST_TICKS < 2**32
        with pytest.raises(HarnessError, match=f"at most {MOST_TICKS} ticks"):
            ticks_of(scenario, orbits * (1.0 + 1e-9))

    def test_allows_a_month_at_ten_hertz(self):
        month = load("microsat", parse_settings(("time.tick_hz=10",)))
        orbits = 30 * 86400 / orbit_period_s(month)
        assert ticks_of(month, orbits) == 25_920_000

    def test_of_a_scenario_names_its_key(self):
        with pytest.raises(HarnessError, match=r"^time\.orbits=90000: a run has at most"):
            ticks_of(load("microsat", parse_settings(("time.orbits=90000", "time.tick_hz=10"))), None)


DECAYED_ABOARD = {
    "time": {"epoch_utc": "2015-06-01T00:00:00Z"},
    "flight": {
        "orbit": {
            "tle": [
                "1 22826U 93061D   15086.11593543  .00000251  00000-0  99999+0 0  9992",
                "2 22826  98.6946  36.4208 0008932 173.8349 186.2944 14.30166407121352",
            ]
        }
    },
}


def test_elements_that_have_decayed_aboard_alone_are_refused():
    """The plant could fly it."""
    with pytest.raises(TableError, match=r"\[flight\]: orbit\.tle: the elements are at 379665 km on 2015"):
        load("microsat", DECAYED_ABOARD)


def test_what_flies_is_not_refused_before_the_run_begins():
    scenario = load("microsat")
    check_can_fly(scenario, 1)
    check_plant(scenario, 1)


class TestRecord:
    @pytest.fixture
    def run(self, tmp_path):
        """A run directory that has been begun, and its scenario."""
        scenario = load("microsat")
        run_dir.begin(tmp_path / "run", scenario, 3, TICKS, "scripted", LOCKSTEP)
        return tmp_path / "run", scenario

    def test_leaves_log_histories_and_what_was_flown(self, run, bus_of):
        path, scenario = run
        bus = bus_of([BOOT], answer=lambda tick: [TickDone(tick, 7).encode()])
        record_flight(path, scenario, bus)
        log = path / "bus.log"
        kept = json.loads((path / "run.json").read_text())
        assert (kept["flown"]["ticks"], kept["flown"]["slips"]) == (TICKS, 0)
        assert kept["digests"]["bus.log"] == hashlib.sha256(log.read_bytes()).hexdigest()
        assert "second_senders" not in kept or kept["second_senders"] == []
        with TruthReader(path / "truth.h5") as truth:
            assert truth.complete == TICKS
            assert truth.attributes == {
                "scenario": "microsat",
                "seed": 3,
                "epoch_utc": datetime.fromtimestamp(scenario.epoch_unix_s, UTC).isoformat(),
                "epoch_unix_s": scenario.epoch_unix_s,
                "tick_hz": 1,
                "torquer_version": version("torquer"),
            }
        assert bus.closed

    def test_names_a_second_sender(self, run, bus_of):
        path, scenario = run
        foreign = TickDone(4000, 7).encode()
        answer = {2: [foreign]}
        record_flight(
            path,
            scenario,
            bus_of([BOOT], answer=lambda tick: [*answer.get(tick, []), TickDone(tick, 7).encode()]),
        )
        (sender,) = json.loads((path / "run.json").read_text())["second_senders"]
        assert sender["message"] == "TICK_DONE"

    @pytest.mark.interpreted
    def test_keeps_what_was_flown_before_the_answers_stopped(self, run, bus_of, monkeypatch):
        path, scenario = run
        monkeypatch.setattr(fsw_answers, "ANSWER_TIMEOUT_S", 0.0)
        noise = Frame(0x7FF, b"")
        bus = bus_of([BOOT], answer=lambda tick: [noise, TickDone(tick, 7).encode()] if tick < 3 else [])
        with pytest.raises(FlightError, match="to tick 3"):
            record_flight(path, scenario, bus)
        assert bus.closed
        assert TickDone.decode(list(read_log(path / "bus.log"))[-1].frame.data).tick == 2
        assert "flown" not in json.loads((path / "run.json").read_text())
