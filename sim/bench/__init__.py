"""``torquer hil``: the flight software in real time against boards."""
