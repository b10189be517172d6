"""``torquer faults``: the table of faults, each injected into flights and judged by independent audits."""
