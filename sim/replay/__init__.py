"""Replay: a log through the flight software again, through the plant, or onto a bus."""
