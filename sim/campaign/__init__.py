"""Studies of many flights, run in parallel on the cores of the machine."""
