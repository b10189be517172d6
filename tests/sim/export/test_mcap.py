"""MCAP, opened again by the mcap reader: every frame as signals, the attitude, the plant's histories."""

import json
from collections import Counter

import numpy as np
import pytest
from mcap.reader import make_reader

from fsw.wire.messages import CLASSES, NAMES, intact
from sim.export.mcap import write_mcap
from sim.export.source import open_source

UNITS = ("_nt", "_rad", "_radps", "_ms", "_s", "_ma")


class Recording:
    """What an MCAP file holds: (time_ns, data) by topic, and the schema of each topic."""

    def __init__(self, path):
        self.by_topic, self.schemas = {}, {}
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            for schema, channel, message in reader.iter_messages():
                self.by_topic.setdefault(channel.topic, []).append((message.log_time, message.data))
                self.schemas[channel.topic] = schema
            self.metadata = {found.name: found.metadata for found in reader.iter_metadata()}

    def values(self, topic):
        """The JSON messages of a topic."""
        return [json.loads(data) for _, data in self.by_topic[topic]]


@pytest.fixture(scope="session")
def recording(exported):
    return Recording(exported("mcap"))


@pytest.mark.long
def test_every_frame_of_the_log_is_there_at_its_time(flight, recording):
    in_log = Counter((NAMES[entry.frame.can_id], 1000 * entry.timestamp_us) for entry in flight.entries)
    in_file = Counter(
        (topic.removeprefix("/can/"), time_ns)
        for topic, messages in recording.by_topic.items()
        if topic.startswith("/can/")
        for time_ns, _ in messages
    )
    assert in_file == in_log


def test_signals_have_the_values_of_the_wire(flight, recording):
    """Each message in turn: its signals, named with their units, are what the flight software decodes."""
    checked = 0
    for can_id, name in NAMES.items():
        frames = [entry.frame for entry in flight.entries if entry.frame.can_id == can_id]
        values = recording.values(f"/can/{name}") if frames else []
        for frame, found in zip(frames, values, strict=True):
            for field, value in CLASSES[can_id].decode(frame.data).by_name().items():
                (named,) = (
                    key
                    for key in found
                    if key == field or (key.startswith(field) and key[len(field) :] in UNITS)
                )
                assert found[named] == value
                checked += 1
    assert checked > 10_000


def test_names_end_with_units_and_choices_have_their_names(recording):
    assert set(recording.values("/can/MAG_FIELD")[0]) == {"counter", "valid", "b_x_nt", "b_y_nt", "b_z_nt"}
    quality = recording.values("/can/NAV_QUALITY")[-1]
    assert quality["mode_name"] == ("SAFE", "DETUMBLE", "ACQUIRE", "POINT")[quality["mode"]]
    assert "sigma3_attitude_rad" in quality
    schema = json.loads(recording.schemas["/can/MAG_FIELD"].data)
    assert "[nT]" in schema["properties"]["b_x_nt"]["description"]
    assert schema["description"].startswith("Magnetic field in body axes")


def test_histories_are_those_of_the_plant(flight, recording):
    rows = recording.values("/truth")
    assert len(rows) == 400
    assert [[row["b_body_t"][axis] for axis in "xyz"] for row in rows] == flight.truth["b_body_t"].tolist()
    assert [row["lit"] for row in rows] == flight.truth["lit"].tolist()
    torque = [row["torque_body_nm_coils"]["z"] for row in rows]
    assert torque == flight.truth["torque_body_nm/coils"][:, 2].tolist()


def fields(data):
    """The fields of a protobuf message by number: integers, doubles and bytes, read by its wire format."""
    found, index = {}, 0
    while index < len(data):
        key, index = varint(data, index)
        kind = key & 7
        if kind == 0:
            value, index = varint(data, index)
        elif kind == 1:
            value, index = float(np.frombuffer(data[index : index + 8], "<f8")[0]), index + 8
        elif kind == 2:
            length, index = varint(data, index)
            value, index = data[index : index + length], index + length
        else:
            value, index = data[index : index + 4], index + 4
        found.setdefault(key >> 3, []).append(value)
    return found


def varint(data, index):
    value = shift = 0
    while True:
        byte = data[index]
        value |= (byte & 0x7F) << shift
        index, shift = index + 1, shift + 7
        if byte < 0x80:
            return value, index


def attitudes(recording, child):
    """Scalar-first quaternions of the transforms to a frame, in order."""
    found = []
    for _, data in recording.by_topic["/tf"]:
        (transform,) = map(fields, fields(data)[1])
        assert transform[2] == [b"orbit"]
        if transform[3] == [child]:
            (rotation,) = map(fields, transform[5])
            found.append([rotation.get(number, [0.0])[0] for number in (4, 1, 2, 3)])
    return np.array(found)


def test_attitudes_are_transforms_that_foxglove_knows(flight, recording):
    assert recording.schemas["/tf"].name == "foxglove.FrameTransforms"
    assert np.array_equal(attitudes(recording, b"body"), flight.truth["q_body_from_orbit"])
    estimated = attitudes(recording, b"body_estimate")
    true = flight.truth["q_body_from_orbit"][-1]
    assert len(estimated) > 100
    assert abs(float(estimated[-1] @ true)) > 0.9999
    assert recording.schemas["/scene"].name == "foxglove.SceneUpdate"
    assert len(recording.by_topic["/scene"]) == 400


def test_the_file_says_which_flight_it_is_of(recording):
    assert recording.metadata["torquer"]["scenario"] == "microsat"
    assert recording.metadata["torquer"]["seed"] == "5"


def test_frames_that_are_no_message_are_kept_as_they_are(flight, tmp_path):
    whole = next(entry.frame for entry in flight.entries if NAMES[entry.frame.can_id] == "MAG_FIELD")
    broken = bytes([whole.data[0] ^ 0x10]) + whole.data[1:]
    assert not intact(whole.replace(data=broken))
    log = tmp_path / "any.log"
    log.write_text(
        f"(1.000000) x 7AB#0102\n(2.000000) x 110#{broken.hex()}\n(3.000000) x 110#{whole.data.hex()}\n"
    )
    notes = write_mcap(open_source(log), tmp_path / "out.mcap", lambda done: None)
    recording = Recording(tmp_path / "out.mcap")
    assert recording.values("/can/other") == [
        {"id": "7AB", "data": "0102", "why": "unknown"},
        {"id": "110", "data": broken.hex(), "why": "broken"},
    ]
    assert len(recording.by_topic["/can/MAG_FIELD"]) == 1
    assert notes == ["the log has no end mark: the flight was cut short"]
