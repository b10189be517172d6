"""The run directory: bus log, truth, estimates, run.json, and the digests that bind them together."""
