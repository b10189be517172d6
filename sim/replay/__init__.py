"""Replay of a log: through the flight software, through the plant, or onto a bus."""
