"""Gains of the laws that point one axis."""
