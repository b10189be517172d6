"""The coil drivers and what guards their coils: an interlock by ticks and by time, and the read-back."""
