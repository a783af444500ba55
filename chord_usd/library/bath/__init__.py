"""Bathroom and laundry pieces."""
