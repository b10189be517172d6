"""How studies are run: what cannot be computed fails its claims alone, and what is done is not lost."""
