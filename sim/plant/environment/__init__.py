"""What surrounds the satellite: orbit, Earth, field, Sun, air, whatever its attitude."""
