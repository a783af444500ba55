"""Training data, training and evaluation: never imported by generate."""
