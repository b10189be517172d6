"""The flight loop as a step from state and inbox: no I/O, no clock, no randomness."""
