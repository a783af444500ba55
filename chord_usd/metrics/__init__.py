"""Scores of layouts, scenes and stages."""
