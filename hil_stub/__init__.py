"""Boards between the bus and the physics. They guard themselves; frames in, frames out."""
