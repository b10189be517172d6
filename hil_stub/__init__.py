"""Boards between bus and physics, which enforce their own limits; frames in, frames out."""
