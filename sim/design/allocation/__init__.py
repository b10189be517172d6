"""Torque shared between coils and other actuators."""
