"""The ground side of Torquer: plant, harness, scenarios."""
