"""The environment of the satellite: orbit, Earth, field, Sun and air, independent of attitude."""
