"""Torquer flight software: node, core, onboard table, and its way onto the bus."""

from fsw.compiled import install, refuse_stale_kernel

install()
refuse_stale_kernel()
