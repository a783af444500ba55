"""Sofas, armchairs and chairs."""
