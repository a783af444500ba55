"""What every part shares: what a house is, rasters, measures, files and processes."""
