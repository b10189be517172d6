"""Torquer flight software: node, core, onboard table, and its way onto the bus."""
