"""The onboard table: what its file may say, and the config that the core makes of it."""
