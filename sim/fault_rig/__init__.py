"""Test rigs for flights with faults, and the record of such a flight."""
