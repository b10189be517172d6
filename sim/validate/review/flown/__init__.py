"""Claims on satellites that have flown the laws of the review."""
