"""Laws that minimise the cost of a linear model."""
