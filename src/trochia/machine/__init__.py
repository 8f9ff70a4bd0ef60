"""Frozen descriptions of machines: plain data and the equations that belong to it."""
