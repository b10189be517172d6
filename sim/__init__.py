"""The ground side of Torquer: the plant, and all that flies, judges and shows a flight."""
