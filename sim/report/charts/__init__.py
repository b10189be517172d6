"""The charts of the report: a flight as it is drawn."""
