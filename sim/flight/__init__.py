"""A flight: plant and flight software over a bus, as two processes or in one."""
