"""Finishes of furniture: colours, grain, weave, and their touch."""
