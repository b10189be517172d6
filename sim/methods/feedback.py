"""Three axes, simple feedback (section 3.1)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
