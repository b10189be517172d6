"""Control laws, a file each: gains, law, rows of the table; what they share is in ``plan`` and ``interface``."""
