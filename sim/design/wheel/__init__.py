"""Studies of a satellite with a constant pitch wheel: how fast it comes to rest, on circle and ellipse."""
