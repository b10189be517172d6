"""Stabilisation by spin (section 2.1)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
