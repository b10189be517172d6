"""Laws with the least cost of a linear model."""
