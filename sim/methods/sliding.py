"""Three axes, sliding control (section 3.1)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
