"""Curtains, blinds, rugs, cushions and towels."""
