"""What Foxglove receives: read back from a recording of the same channels."""

import json

import foxglove
import pytest
from mcap.reader import make_reader

from fsw.wire.messages import FswBoot, MagField, NavAttitude, Sync
from sim.errors import HarnessError
from sim.watch.foxglove import Publisher, foxglove_server
from sim.watch.seen import FlightView


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
    context = foxglove.Context()
    with foxglove.open_mcap(path, context=context):
        publisher = Publisher(context, 0)
        publisher.publish(seen)
        publisher.publish(seen)
    with path.open("rb") as file:
        found = [
            (channel.topic, schema.name, message.data)
            for schema, channel, message in make_reader(file).iter_messages()
        ]
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


def test_a_port_that_is_taken_is_named():
    with foxglove_server(0) as first, pytest.raises(HarnessError, match=f"--port {first.port}"):
        foxglove_server(first.port).__enter__()
