"""Prediction, adaptation and the papers of PoSAT-1 (sections 3.3, 3.4)."""

from sim.methods.method import Method

METHODS: tuple[Method, ...] = ()
