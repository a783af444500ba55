"""Reading of clean drawings by their strokes: exact to a pixel where walls are plainly drawn."""
