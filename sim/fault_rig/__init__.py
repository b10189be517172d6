"""Flights with faults: the rigs on which they are flown, and what is kept of them."""
