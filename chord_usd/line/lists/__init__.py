"""Lists before pixels: the pieces of a room are written down before a layout is painted."""
