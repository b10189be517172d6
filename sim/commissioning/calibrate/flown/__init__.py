"""Calibration from runs and logs with pulses, along the modelled orbit."""
