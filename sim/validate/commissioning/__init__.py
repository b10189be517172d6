"""Claims on commissioning: the wiring that a sequence of pulses finds, and what it calibrates."""
