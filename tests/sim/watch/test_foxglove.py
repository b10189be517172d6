"""What Foxglove receives: read back from a recording of the same channels."""

import json
import socket
import threading

import foxglove
import pytest
from mcap.reader import make_reader

from fsw.wire.messages import (
    CoilRefused,
    CoilRefusedReason,
    CoilStatus,
    FswBoot,
    MagField,
    NavAttitude,
    Sync,
)
from sim.errors import HarnessError
from sim.watch.flight_view import MOST_HAPPENINGS, FlightView
from sim.watch.foxglove import Publisher, foxglove_server
from sim.watch.source import Batch, batches


def recorded(path, publish):
    """Topic, schema and data of what is published."""
    context = foxglove.Context()
    with foxglove.open_mcap(path, context=context):
        publish(Publisher(context, 0))
    with path.open("rb") as file:
        return [
            (channel.topic, schema.name, message.data)
            for schema, channel, message in make_reader(file).iter_messages()
        ]


def test_attitude_directions_series_and_events_are_sent(tmp_path):
    path = tmp_path / "live.mcap"
    seen = FlightView()
    for message in (
        FswBoot(0, 1, 5),
        MagField(1, 2e4, 0.0, 0.0),
        NavAttitude(1, 0.3, -0.2, 0.1),
        Sync(4, 1427424417),
    ):
        seen.take(message.encode(), 0.0)

    def publish(publisher):
        publisher.publish(seen)
        publisher.publish(seen)

    found = recorded(path, publish)
    topics = [topic for topic, _, _ in found]
    assert topics.count("/tf") == topics.count("/scene") == topics.count("/state") == 2
    assert topics.count("/events") == 1, "what has happened is told once"
    state = next(json.loads(data) for topic, _, data in found if topic == "/state")
    assert (state["tick"], state["valid"]) == (4, True)
    assert {name for _, name, _ in found} >= {
        "foxglove.FrameTransforms",
        "foxglove.SceneUpdate",
        "foxglove.Log",
    }


def test_the_arrows_of_a_pulse_are_taken_away_after_it(tmp_path):
    seen = FlightView()

    def publish(publisher):
        for level in (2, 0, 0):
            for message in (CoilStatus(level, 1, 2000, 100, 100_000, 1), Sync(4, 1427424417)):
                seen.take(message.encode(), 0.0)
            publisher.publish(seen)

    scenes = [data for topic, _, data in recorded(tmp_path / "live.mcap", publish) if topic == "/scene"]
    assert [b"dipole" in data for data in scenes] == [True, True, False], "shown, deleted, gone"


def test_all_that_happens_in_one_batch_is_an_event(tmp_path):
    seen = FlightView()
    refusals = [(CoilRefused(2, 7, CoilRefusedReason.LOCKOUT, 33).encode(), 0.0)] * 4000

    class OneBatch:
        name = "one batch"

        def batches(self):
            yield Batch([(Sync(4, 1427424417).encode(), 0.0), *refusals], 0.0)

    def publish(publisher):
        for _ in batches(OneBatch(), seen):
            publisher.publish(seen)

    topics = [topic for topic, _, _ in recorded(tmp_path / "live.mcap", publish)]
    assert topics.count("/events") == 4000


def test_what_is_forgotten_before_the_first_sync_is_numbered(tmp_path):
    seen = FlightView()
    for message in (*[FswBoot(0, 1, 5)] * (MOST_HAPPENINGS + 9), Sync(4, 1427424417)):
        seen.take(message.encode(), 0.0)
    told = recorded(tmp_path / "live.mcap", lambda publisher: publisher.publish(seen))
    first, *others = [data for topic, _, data in told if topic == "/events"]
    assert b"fsw: started; 9 before it are left out" in first
    assert not any(b"left out" in data for data in others)


def test_a_port_that_is_taken_is_named():
    with foxglove_server(0) as first, pytest.raises(HarnessError, match=f"--port {first.port}"):
        foxglove_server(first.port).__enter__()


@pytest.mark.long
def test_a_client_that_never_says_a_word_does_not_hold_the_end_up():
    ended, connected = threading.Event(), threading.Event()
    port = []

    def serve():
        with foxglove_server(0) as publisher:
            port.append(publisher.port)
            connected.wait()
        ended.set()

    server = threading.Thread(target=serve, daemon=True)
    server.start()
    while not port:
        server.join(0.01)
        assert server.is_alive()
    with socket.create_connection(("127.0.0.1", port[0])):
        server.join(0.3)  # the server takes the connection
        connected.set()
        assert ended.wait(10.0)
