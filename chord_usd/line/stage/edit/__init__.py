"""Changes to a written stage."""
