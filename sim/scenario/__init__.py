"""Scenarios: what their TOML files may say, and what it means to the plant."""
