"""Checks against reference data, a module for each file format."""
