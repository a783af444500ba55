"""Procedural houses drawn as people draw them, with the truth: to score and to train readers."""
