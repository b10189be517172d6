"""The coil drivers and their guards: an interlock by ticks and one by time, and the current read-back."""
