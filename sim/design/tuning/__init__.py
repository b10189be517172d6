"""Gains of any law: searched over flights of a rigid body, kept in files, compared under equal rules."""
