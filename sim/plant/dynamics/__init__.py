"""How the body moves: torques on it and its attitude and rate."""
