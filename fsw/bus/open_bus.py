"""Buses: one small interface over SocketCAN, the loop bus, serial adapters and python-can, opened by a spec.

| spec | bus | ``name`` |
|---|---|---|
| ``socketcan:NAME`` | a CAN interface of this Linux machine, such as vcan0 | NAME |
| ``loop``, ``loop:PORT`` | frames over TCP on 127.0.0.1; whoever opens first hosts it | ``loop`` |
| ``slcan:PORT`` | a serial CAN adapter (needs pyserial) | the port's last component |
| ``can:INTERFACE:CHANNEL``, ``can`` | any other of python-can, as configured | that of the channel |
| ``auto`` | ``socketcan:vcan0`` where it is up, otherwise ``loop`` | |
"""

from fsw.bus.interface import DEFAULT_LOOP_PORT, Bus, BusError

KINDS = "loop[:PORT], socketcan:NAME, slcan:PORT, can:INTERFACE:CHANNEL"
"""What a spec may be, besides ``auto``."""

_AUTO_INTERFACE = "vcan0"


def resolve(spec: str) -> str:
    """The spec in full: ``auto`` becomes the bus it means on this machine, ``loop`` gets its port.

    Raises:
        BusError: no such kind of bus, or its argument is missing or wrong.
    """
    kind, _, argument = spec.partition(":")
    match kind:
        case "can":
            from fsw.bus.python_can import resolve_python_can  # noqa: PLC0415  (loaded if it is used)

            return resolve_python_can(argument)
        case "auto" if not argument:
            return resolve(f"socketcan:{_AUTO_INTERFACE}" if _interface_is_up(_AUTO_INTERFACE) else "loop")
        case "loop":
            return f"loop:{_port(argument, spec)}"
        case "socketcan" | "slcan" if argument:
            return spec
        case "socketcan":
            raise BusError(f"bus '{spec}' names no interface: write for example socketcan:vcan0")
        case "slcan":
            raise BusError(f"bus '{spec}' names no serial port: write for example slcan:/dev/ttyACM0")
        case "virtual":
            raise BusError(
                "bus 'virtual' joins nodes of one process: it cannot be opened by a node of its own"
            )
        case _:
            raise BusError(f"unknown bus '{spec}': use {KINDS} or auto; torquer sil has virtual too")


def open_bus(spec: str) -> Bus:
    """Open the bus that ``spec`` names.

    Raises:
        BusError: the spec is wrong, or the bus cannot be opened here.
    """
    resolved = resolve(spec)
    kind, _, argument = resolved.partition(":")
    # Each kind is imported when it is opened: python-can alone takes longer than all the rest.
    if kind == "loop":
        from fsw.bus.link import LoopLink  # noqa: PLC0415  (loaded if it is used)

        return LoopLink(int(argument))
    if kind == "socketcan":
        from fsw.bus.socketcan import SocketCan  # noqa: PLC0415  (loaded if it is used)

        return SocketCan(argument)
    if kind == "can":
        from fsw.bus.python_can import open_python_can  # noqa: PLC0415  (loaded if it is used)

        return open_python_can(resolved)
    from fsw.bus.python_can import open_slcan  # noqa: PLC0415  (loaded if it is used)

    return open_slcan(argument)


def join_bus(spec: str, end: int) -> Bus:
    """The loop bus of ``spec``, by the inherited descriptor of a socket that is on it already."""
    from socket import socket  # noqa: PLC0415  (loaded if it is used)

    from fsw.bus.link import LoopLink  # noqa: PLC0415  (loaded if it is used)

    return LoopLink(int(spec.removeprefix("loop:")), end=socket(fileno=end))


def host_bus(listener: int, *ends: int) -> Bus:
    """The loop bus, served by this process, by inherited descriptors.

    Args:
        listener: of the socket on which others are accepted.
        ends: of connections that are on the bus from the start.
    """
    from socket import socket  # noqa: PLC0415  (loaded if it is used)

    from fsw.bus.link import HostLink  # noqa: PLC0415  (loaded if it is used)

    return HostLink(socket(fileno=listener), [socket(fileno=end) for end in ends])


def _port(argument: str, spec: str) -> int:
    if not argument and ":" not in spec:
        return DEFAULT_LOOP_PORT
    if argument.isascii() and argument.isdigit() and len(argument) <= 5 and 0 < int(argument) < 2**16:
        return int(argument)
    raise BusError(
        f"bus '{spec[:40]}' names no TCP port: write loop or loop:PORT with a port from 1 to 65535"
    )


def _interface_is_up(name: str) -> bool:
    from fsw.bus.socketcan import interface_is_up  # noqa: PLC0415  (loaded if it is used)

    return interface_is_up(name)
