"""How the satellite rotates, and how errors of attitude, rate and parameters evolve with it."""
