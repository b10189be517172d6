"""Torquer flight software: what flies."""
