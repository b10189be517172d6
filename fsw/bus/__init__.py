"""A node's way onto a bus: SocketCAN, loop bus, serial adapters, python-can behind one small interface."""
