"""Torquer flight software: node, core, onboard table, and its way onto the bus."""

from fsw.kernel import refuse_stale_kernel

refuse_stale_kernel()
