"""Gains of the laws of a spinning satellite."""
