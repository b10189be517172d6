"""The flight loop as a pure step: no I/O, no clock, no randomness."""
