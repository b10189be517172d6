"""Conformance of a board, stub or hardware, with docs/icd.md."""
