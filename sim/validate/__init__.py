"""``torquer validate``: every claim and reference figure, computed and judged."""
