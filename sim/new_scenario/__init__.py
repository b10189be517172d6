"""A scenario for a user's satellite, written from a few figures, which flies at once."""
