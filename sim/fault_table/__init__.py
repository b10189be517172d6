"""``torquer faults``: the table of faults, each flown and judged by independent audit."""
