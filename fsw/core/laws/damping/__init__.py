"""Laws that take the rate away."""
