"""What a house is: artefacts, units, geometry, categories, words, and its JSON."""
