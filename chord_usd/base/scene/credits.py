"""Whose the things are that this repository draws."""

from __future__ import annotations

AUTHOR = "CHOrD USD"
LICENCE = "CC0-1.0"
"""Of furniture and looks that are drawn here; what others made keeps theirs."""

DRAWN_ON = "2026-11-28"
"""What drawn furniture says of its age: a fixed day, so that the same design is the same bytes."""
