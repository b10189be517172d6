"""Files and options of a node: read within bounds, each fault reported in one sentence."""
