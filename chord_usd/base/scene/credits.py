"""Whose the things are that this repository draws."""

from __future__ import annotations

AUTHOR = "CHOrD USD"
LICENCE = "CC0-1.0"
"""Of furniture and looks that are drawn here; what others made keeps theirs."""
