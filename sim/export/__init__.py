"""Runs and the bus contract in the formats of other tools."""
