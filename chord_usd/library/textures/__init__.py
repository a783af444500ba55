"""Rasters of one repeat of a surface, which looks and finishes are drawn on."""
