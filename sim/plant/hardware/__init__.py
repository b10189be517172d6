"""Sensors and coils: their physics, and the coil driver boards that drive the coils."""
