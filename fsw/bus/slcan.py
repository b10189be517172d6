"""Serial CAN adapters by the slcan protocol, at the bit rate of the bench."""

from pathlib import PurePath

import can

from fsw.bus.interface import Bus, BusError
from fsw.bus.python_can import PythonCan

SLCAN_BITRATE = 500_000


def open_slcan(port: str) -> Bus:
    """The serial CAN adapter at ``port``, set to 500 kbit/s.

    Raises:
        BusError: pyserial is missing, or there is no adapter.
    """
    try:
        bus = can.Bus(interface="slcan", channel=port, bitrate=SLCAN_BITRATE)
    except can.CanInterfaceNotImplementedError as error:
        raise BusError("a serial CAN adapter needs pyserial: install it with pip install pyserial") from error
    except (can.CanError, OSError, ValueError) as error:
        raise BusError(f"there is no serial CAN adapter at {port}: {error}") from error
    return PythonCan(bus, PurePath(port).name, f"slcan:{port}")
