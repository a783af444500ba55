"""Procedural houses, readers of house data sets, splits."""
