"""A board as a process on a bus: its command line, its loop and its stimulus."""
