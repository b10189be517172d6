"""Laws that point one axis, where something else holds the others."""
