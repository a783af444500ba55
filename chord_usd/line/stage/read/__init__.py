"""Facts read back from a written stage."""
