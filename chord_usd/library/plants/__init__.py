"""Plants in pots."""
