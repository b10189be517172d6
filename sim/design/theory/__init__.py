"""Gain design as theory: linearisation, Floquet analysis, search, pulses, robustness, periodic LQR."""
