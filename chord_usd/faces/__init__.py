"""Ways into the program: verbs, the page, batches, farms."""
