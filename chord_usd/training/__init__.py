"""Training loops and their configurations."""
