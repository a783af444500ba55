"""Geometry of walls, floors, openings, stairs and roofs."""
