"""Whether a board, stub or hardware, does what docs/icd.md says."""
