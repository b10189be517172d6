"""Calibration of sensors, coils and body by what was sent or recorded; and what the data cannot tell."""
