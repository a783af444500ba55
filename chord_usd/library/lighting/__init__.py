"""Lamps on tables, floors, walls and ceilings."""
