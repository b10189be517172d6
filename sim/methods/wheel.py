"""A wheel beside the coils (sections 2.2, 2.4)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
