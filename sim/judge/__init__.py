"""Judges any team's flight software against the satellites, faults and guards of this project."""
