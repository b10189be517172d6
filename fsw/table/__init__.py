"""The onboard table: the schema of its file, and the configuration of the core made from it."""
