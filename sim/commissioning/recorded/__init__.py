"""What a satellite recorded in orbit, where it was then, and what is known of its sensors."""
