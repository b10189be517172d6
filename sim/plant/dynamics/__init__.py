"""Rotation of the body: torques, attitude and rate."""
