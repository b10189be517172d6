"""Laws of a satellite with a momentum wheel."""
