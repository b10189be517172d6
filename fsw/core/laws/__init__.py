"""Control laws, a file each: gains, law and rows of the table; what they share is in ``plan``."""
