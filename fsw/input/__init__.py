"""What people give to a node: files and options, read within bounds, their faults told in one sentence."""
