"""A node's way onto a bus: SocketCAN, the loop bus and serial adapters behind one small interface."""
