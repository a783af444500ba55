"""Kitchens composed as runs of units along walls, before they are painted."""
