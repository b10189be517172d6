"""Satellites that the claims fly."""
