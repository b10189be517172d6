"""Scenarios: the schema of their TOML files, and the configuration of the plant from them."""
