"""Fault detection, isolation and recovery: which coil or sensor is faulty."""
