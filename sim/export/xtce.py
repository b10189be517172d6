"""The bus contract as XTCE 1.2: a subsystem a message, with its container and its signals as parameters.

A packet is a frame with its identifier before it, two bytes big-endian: the bytes that the CRC covers, then
the CRC. Signals lie as in the DBC: the byte order is ``leastSignificantByteFirst``, and bits are counted from
the lowest of each byte, as Yamcs does it in this order.
"""

from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from sim.errors import needing
from sim.export.dictionary import Message, Signal, messages

if TYPE_CHECKING:
    from yamcs.pymdb import System

ID_BITS = 16
COUNTER = "rises by one with each frame of this message, modulo 16"
CRC = "CRC-8, polynomial 0x1D, initial value and final XOR 0xFF, over identifier and bytes before it"
_NAMESPACE = "http://www.omg.org/spec/XTCE/20180204"
_SCHEMA_INSTANCE = "http://www.w3.org/2001/XMLSchema-instance"
_XTCE = f"{{{_NAMESPACE}}}"


def xtce_text() -> str:
    """The XTCE document.

    Raises:
        HarnessError: the package yamcs-pymdb is missing.
    """
    with needing("XTCE", "yamcs-pymdb", "xtce"):
        from yamcs import pymdb  # noqa: PLC0415  an extra
    system = pymdb.System("torquer", short_description="Bus of Torquer: one container a CAN message")
    encoding = pymdb.IntegerEncoding(bits=ID_BITS)
    identifier = pymdb.IntegerParameter(
        system, "can_id", signed=False, short_description="identifier of the frame", encoding=encoding
    )
    frame = pymdb.Container(system, "frame", entries=[pymdb.ParameterEntry(identifier)], abstract=True)
    for message in messages():
        _add_message(pymdb, system, message, frame, identifier)
    return _completed(system.dumps(top_comment=False))


def _add_message(pymdb: Any, system: "System", message: Message, frame: Any, identifier: Any) -> None:  # noqa: ANN401  of pymdb
    subsystem = pymdb.Subsystem(system, message.name, short_description=f"from {message.sender}")
    entries, end = [], 0
    for signal in message.signals:
        parameter = _parameter(pymdb, subsystem, signal)
        entries.append(pymdb.ParameterEntry(parameter, offset=signal.start - end))
        end = signal.start + signal.length
    pymdb.Container(
        subsystem,
        message.name,
        entries=entries,
        base=frame,
        condition=pymdb.EqExpression(identifier, message.can_id),
        bits=ID_BITS + 8 * message.length,
        short_description=message.comment,
        rate=message.cycle_ms / 1000.0 or None,
    )


def _parameter(pymdb: Any, subsystem: Any, signal: Signal) -> Any:  # noqa: ANN401  of yamcs-pymdb
    schemes = pymdb.IntegerEncodingScheme
    common: dict[str, Any] = {
        "short_description": {"counter": COUNTER, "crc": CRC}.get(signal.name, signal.comment) or None,
        "units": signal.unit or None,
        "encoding": pymdb.IntegerEncoding(
            bits=signal.length,
            little_endian=True,
            scheme=schemes.TWOS_COMPLEMENT if signal.signed else schemes.UNSIGNED,
        ),
    }
    if signal.choices:
        return pymdb.EnumeratedParameter(
            subsystem, signal.name, choices=list(signal.choices.items()), **common
        )
    if signal.scale != 1.0:
        common["calibrator"] = pymdb.Polynomial([0.0, signal.scale])
    common |= {"minimum": signal.low, "maximum": signal.high}
    if not signal.is_whole:
        return pymdb.FloatParameter(subsystem, signal.name, bits=64, **common)
    common |= {"minimum": int(signal.low), "maximum": int(signal.high)}
    return pymdb.IntegerParameter(subsystem, signal.name, signed=signal.signed, bits=32, **common)


def _completed(text: str) -> str:
    """The document with what yamcs-pymdb does not write: the CRC, and the byte order of short signals.

    The byte order says from which end the bits of a byte are counted, so that it counts for any length.
    """
    ElementTree.register_namespace("", _NAMESPACE)
    ElementTree.register_namespace("xsi", _SCHEMA_INSTANCE)
    root = ElementTree.fromstring(text)
    for message in root.iterfind(f"{_XTCE}SpaceSystem"):
        for encoding in message.iter(f"{_XTCE}IntegerDataEncoding"):
            encoding.set("byteOrder", "leastSignificantByteFirst")
        for kind in message.iter(f"{_XTCE}IntegerParameterType"):
            if kind.get("name") == "crc":
                kind[0].insert(0, _crc())
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _crc() -> ElementTree.Element:
    check = ElementTree.Element(f"{_XTCE}ErrorDetectCorrect")
    crc = ElementTree.SubElement(check, f"{_XTCE}CRC", width="8")
    for name, value in (("Polynomial", "1D"), ("InitRemainder", "FF"), ("FinalXOR", "FF")):
        ElementTree.SubElement(crc, f"{_XTCE}{name}").text = value
    return check
