"""Beds and their headboards."""
