"""A run as it lies on disk: bus log, truth, estimates, run.json, and what binds them together."""
