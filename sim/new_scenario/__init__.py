"""A scenario for a satellite of one's own, written from a few figures, which flies at once."""
