"""Adapters at the edge of the flight software: buses, tables, the runner."""
