"""Sources: logs by their time, buses on which nothing is sent."""

import socket
import threading
from time import monotonic

import pytest

from fsw.bus.interface import BusError
from fsw.bus.link import LoopLink
from fsw.wire.frame import Frame
from fsw.wire.messages import CoilRefused, CoilRefusedReason
from sim.errors import HarnessError
from sim.record.pace import LOCKSTEP, Pace
from sim.watch.flight_view import MOST_HAPPENINGS, FlightView
from sim.watch.source import Batch, BusSource, LogSource, batches

LINES = [f"({1000.0 + 0.5 * number:.6f}) loop 7{number:02d}#0{number}" for number in range(5)]


@pytest.fixture
def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def log(tmp_path):
    path = tmp_path / "some.log"
    path.write_text("\n".join(LINES) + "\n")
    return path


def frames(source):
    return [frame for batch in source.batches() for frame in batch.frames]


class TestLog:
    def test_all_frames_come_with_their_time(self, log):
        found = frames(LogSource(log, LOCKSTEP))
        assert [frame.can_id for frame, _ in found] == [0x700, 0x701, 0x702, 0x703, 0x704]
        assert [time_s for _, time_s in found] == [1000.0, 1000.5, 1001.0, 1001.5, 1002.0]

    @pytest.mark.long
    def test_at_its_pace(self, log):
        began = monotonic()
        assert len(frames(LogSource(log, Pace(10.0)))) == 5
        assert 0.2 <= monotonic() - began < 2.0

    def test_a_gap_of_years_is_passed_over(self, tmp_path):
        path = tmp_path / "gap.log"
        path.write_text("(1.000000) x 100#\n(900000000.000000) x 101#\n")
        began = monotonic()
        assert len(frames(LogSource(path, Pace(50_000.0)))) == 2
        assert monotonic() - began < 2.0

    def test_one_that_is_cut_short_says_so_after_its_whole_lines(self, log):
        log.write_text(log.read_text()[:-4])
        source = LogSource(log, LOCKSTEP)
        assert len(frames(source)) == 4
        assert source.cut_short

    def test_what_is_no_log_is_refused(self, log, tmp_path):
        for path in (tmp_path / "none", tmp_path):
            with pytest.raises(HarnessError, match=r"no such file|no bus\.log"):
                LogSource(path, LOCKSTEP)
        log.write_text("no log\n")
        with pytest.raises(HarnessError, match="not a candump log"):
            frames(LogSource(log, LOCKSTEP))

    def test_beside_nothing_there_is_no_scenario(self, log):
        assert LogSource(log, LOCKSTEP).scenario() is None


class TestBus:
    @pytest.mark.long
    def test_a_loop_bus_is_waited_for_not_hosted_and_its_end_ends(self, free_port):
        source = BusSource(f"loop:{free_port}").batches()
        assert next(source).frames == []
        host = LoopLink(free_port)
        other = LoopLink(free_port)
        received = []

        def read():
            received.extend(frame for batch in source for frame, _ in batch.frames)

        reader = threading.Thread(target=read)
        reader.start()
        deadline = monotonic() + 10.0
        while not received and monotonic() < deadline:
            other.send([Frame(0x123, b"\x01")])
            other.receive(0.05)
        assert host.receive(1.0) == Frame(0x123, b"\x01")
        assert host.receive(0.0) in {None, Frame(0x123, b"\x01")}, "the watcher sends nothing"
        host.close()
        reader.join(10.0)
        assert not reader.is_alive()
        assert received[0] == Frame(0x123, b"\x01")
        other.close()

    def test_there_is_no_such_bus(self):
        with pytest.raises(BusError, match="unknown bus 'nowhere'"):
            BusSource("nowhere")


class TestHandingOn:
    def test_it_stops_before_anything_that_happens_is_forgotten(self):
        """Of a batch with more than is kept, whoever looks at each stop sees all."""
        refusal = CoilRefused(2, 7, CoilRefusedReason.LOCKOUT, 33).encode()
        count = 8 * MOST_HAPPENINGS + 3

        class OneBatch:
            name = "one batch"

            def batches(self):
                yield Batch([(refusal, 0.0)] * count, 0.0)

        seen = FlightView()
        found = {one.number for _ in batches(OneBatch(), seen) for one in seen.happenings}
        assert found == set(range(1, count + 1))
