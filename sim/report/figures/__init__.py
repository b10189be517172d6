"""What a flight achieved, in figures: against the plant's truth, tick by tick and as a whole."""
