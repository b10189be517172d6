"""Torquer for its users: the command line over flight software, boards and simulator."""
