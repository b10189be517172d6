"""Studies on the ground of laws that feed attitude and rate back: gains, bounds on them, and their cost."""
