"""Three axes, optimal control of a linear model (section 3.2)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
