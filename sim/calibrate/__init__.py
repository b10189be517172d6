"""Calibration of magnetometer, Sun cells and body by what was recorded; and what the data cannot tell."""
