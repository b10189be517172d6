"""Faults as data, and their injection into plant, boards, bus and flight software."""
