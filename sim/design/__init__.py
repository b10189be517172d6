"""Gain design on the ground: linearisation, Floquet analysis, search, pulses, robustness, periodic LQR."""
