"""Composition root: command line, SIL run, replay, audit, report."""
