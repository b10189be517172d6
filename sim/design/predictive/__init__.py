"""Predictive control studied on the ground."""
