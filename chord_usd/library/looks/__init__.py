"""Looks of walls and floors, sampled by family and parameters."""
