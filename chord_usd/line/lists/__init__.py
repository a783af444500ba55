"""Lists before pixels: what shall be in a room is written down before a layout is painted."""
