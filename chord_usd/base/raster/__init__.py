"""Pictures as arrays: what is drawn on them, and what is found in them again."""
