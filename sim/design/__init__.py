"""``torquer design``: gains for a scenario from Floquet theory."""
