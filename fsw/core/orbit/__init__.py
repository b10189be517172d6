"""Orbit, field and Sun as the satellite expects them."""
