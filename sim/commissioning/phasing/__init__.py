"""Phasing: which way coils and magnetometer are wired, from pulses of each coil in both polarities."""
