"""Effects that ship, for ``[[effect]]``: torques that few satellites have."""
