"""Rows of the fault table, and the order in which they stand on the page."""
