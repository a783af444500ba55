"""Checkpoints and a held-out split -> scores."""
