"""Populations of random satellites: the claims on them, and the page of what each did."""
