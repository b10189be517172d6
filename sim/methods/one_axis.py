"""Gravity gradient, Sun, drag and other help (sections 2.3, 2.4)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
