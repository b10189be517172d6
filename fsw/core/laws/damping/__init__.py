"""Laws that damp the rate."""
