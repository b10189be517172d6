"""XTCE: valid by its schema; an independent reading of it decodes frames as the wire does."""

from pathlib import Path
from xml.etree import ElementTree

import cantools
import pytest
import space_packet_parser
import xmlschema

from fsw.wire.frame import Frame
from fsw.wire.messages import CLASSES, NAMES
from sim.export.dictionary import DBC
from sim.export.xtce import xtce_text

XTCE = "{http://www.omg.org/spec/XTCE/20180204}"
SCHEMA = Path(space_packet_parser.__file__).parent / "xtce" / "schemas" / "SpaceSystem.xsd"
DATABASE = cantools.database.load_file(DBC)
ORDERS = {"mostSignificantByteFirst": "big", "leastSignificantByteFirst": "little"}


class Decoder:
    """Decodes packets by the document alone: containers, conditions, entries, encodings, calibrators."""

    def __init__(self, text):
        self.root = ElementTree.fromstring(text)
        self.containers = {
            int(system.find(f".//{XTCE}Condition/{XTCE}Value").text): system
            for system in self.root.iterfind(f"{XTCE}SpaceSystem")
        }

    def decode(self, packet):
        """(name of the container, values by parameter: calibrated numbers or labels)."""
        (identifier,) = self.root.iterfind(f"{XTCE}TelemetryMetaData/{XTCE}ParameterTypeSet/*")
        can_id, position = self.raw(packet, 0, identifier.find(f"{XTCE}IntegerDataEncoding"))
        system = self.containers[can_id]
        types = {kind.get("name"): kind for kind in system.iterfind(f".//{XTCE}ParameterTypeSet/*")}
        kinds = {
            parameter.get("name"): types[parameter.get("parameterTypeRef")]
            for parameter in system.iterfind(f".//{XTCE}ParameterSet/{XTCE}Parameter")
        }
        container = system.find(f".//{XTCE}SequenceContainer")
        values = {}
        for entry in container.iterfind(f"{XTCE}EntryList/{XTCE}ParameterRefEntry"):
            location = entry.find(f"{XTCE}LocationInContainerInBits")
            assert location.get("referenceLocation") == "previousEntry"
            kind = kinds[entry.get("parameterRef")]
            encoding = kind.find(f"{XTCE}IntegerDataEncoding")
            raw, position = self.raw(
                packet, position + int(location.find(f"{XTCE}FixedValue").text), encoding
            )
            values[entry.get("parameterRef")] = self.calibrated(raw, kind, encoding)
        assert (
            int(container.find(f".//{XTCE}SizeInBits/{XTCE}FixedValue").text) == 8 * len(packet) == position
        )
        return container.get("name"), values

    @staticmethod
    def raw(packet, position, encoding):
        """The raw value of an integer, and the position after it: bits from the end that the order says."""
        length, order = int(encoding.get("sizeInBits")), ORDERS[encoding.get("byteOrder")]
        word = int.from_bytes(packet, order)
        shift = position if order == "little" else 8 * len(packet) - position - length
        value = word >> shift & ((1 << length) - 1)
        if encoding.get("encoding") == "twosComplement" and value >> (length - 1):
            value -= 1 << length
        return value, position + length

    @staticmethod
    def calibrated(raw, kind, encoding):
        labels = {int(one.get("value")): one.get("label") for one in kind.iter(f"{XTCE}Enumeration")}
        if labels:
            return labels.get(raw, raw)
        terms = encoding.findall(f".//{XTCE}Term")
        if terms:
            return sum(float(term.get("coefficient")) * raw ** int(term.get("exponent")) for term in terms)
        return raw

    @staticmethod
    def crc_holds(system, packet):
        """Whether the last byte is the CRC that the document describes, over the bytes before it."""
        found = system.find(f".//{XTCE}CRC")
        if found is None:
            return None
        polynomial, register, final = (
            int(found.find(f"{XTCE}{name}").text, 16) for name in ("Polynomial", "InitRemainder", "FinalXOR")
        )
        for byte in packet[:-1]:
            register ^= byte
            for _ in range(8):
                register = (register << 1 ^ (polynomial if register & 0x80 else 0)) & 0xFF
        return register ^ final == packet[-1]


@pytest.fixture(scope="module")
def text():
    return xtce_text()


@pytest.fixture(scope="module")
def decoder(text):
    return Decoder(text)


def packet_of(frame):
    return frame.can_id.to_bytes(2, "big") + frame.data


@pytest.mark.long
def test_it_is_valid_by_the_schema_of_xtce(text):
    schema = xmlschema.XMLSchema(str(SCHEMA), allow="local")
    schema.validate(text)
    with pytest.raises(xmlschema.XMLSchemaValidationError):
        schema.validate(text.replace("sizeInBits", "sizeInBytes", 1))


@pytest.mark.long
def test_frames_of_a_flight_are_decoded_as_on_the_wire(flight, decoder):
    seen = set()
    for entry in flight.entries:
        check(decoder, entry.frame)
        seen.add(entry.frame.can_id)
    assert len(seen) > 15


@pytest.mark.parametrize("can_id", sorted(CLASSES), ids=NAMES.get)
@pytest.mark.parametrize("filling", [0x00, 0xFF, 0xA5, 0x3C])
def test_every_message_is_decoded_as_on_the_wire(decoder, can_id, filling):
    data = bytes((filling + 37 * index) & 0xFF for index in range(CLASSES[can_id].LENGTH))
    frame = Frame(can_id, data)
    check(decoder, frame.replace(data=CLASSES[can_id].decode(data).encode().data))


def check(decoder, frame):
    name, values = decoder.decode(packet_of(frame))
    assert name == NAMES[frame.can_id]
    expected = CLASSES[frame.can_id].decode(frame.data).by_name()
    crc = values.pop("crc", None)
    assert decoder.crc_holds(decoder.containers[frame.can_id], packet_of(frame)) in (True, None)
    assert crc in (None, frame.data[-1])
    choices = {signal.name: signal.choices or {} for signal in DATABASE.get_message_by_name(name).signals}
    named = {
        field: str(choices[field].get(value, value)) if choices[field] else value
        for field, value in expected.items()
    }
    assert {field: str(value) if choices[field] else value for field, value in values.items()} == named


def test_units_and_ranges_are_those_of_the_dbc(decoder):
    for message in DATABASE.messages:
        system = decoder.containers[message.frame_id]
        for signal in message.signals:
            kind = next(one for one in system.iter() if one.get("name") == signal.name)
            unit = kind.find(f"{XTCE}UnitSet/{XTCE}Unit")
            assert (None if unit is None else unit.text) == (signal.unit or None)
            bounds = kind.find(f"{XTCE}ValidRange")
            if not signal.choices:
                assert float(bounds.get("minInclusive")) == signal.minimum
                assert float(bounds.get("maxInclusive")) == signal.maximum
