"""Reference data, a module a format, each against our own code."""
