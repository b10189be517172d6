"""What is let in from the bus: whole frames, a tick that is believed, one sender of each kind."""
