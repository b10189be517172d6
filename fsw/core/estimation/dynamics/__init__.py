"""How the satellite turns, and how errors of attitude, rate and parameters go on with it."""
