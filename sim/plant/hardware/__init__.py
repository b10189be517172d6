"""The instruments on board: sensors and coils as physics."""
