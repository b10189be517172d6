"""Laws that feed attitude and rate back."""
