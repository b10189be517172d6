"""Gains of any law: searched by flights of a rigid body under the same rules for all, kept in files."""
