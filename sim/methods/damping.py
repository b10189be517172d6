"""Damping of the rate (section 1 of the review)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
