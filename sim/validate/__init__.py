"""``torquer validate``: every claim and reference figure, reproduced and judged."""
