"""Whether a flight meets the requirements of its scenario, and where it does not, why."""
