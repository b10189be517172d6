"""Control laws, one a module."""
