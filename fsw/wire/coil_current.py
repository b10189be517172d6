"""Currents in ``COIL_STATUS``: what it carries, and what a board may read of coils that are off."""

MOST_MA, STEP_MA = 2047.0, 1.0
"""The largest current that ``current_ma`` carries, and its step."""
OFF_PART = 0.1
"""What may be read while all coils are off, as a fraction of the nominal current of level 1."""
