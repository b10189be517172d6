"""How near pulses come to the least error that any dipole leaves: the same law and scheduler, many coils."""
