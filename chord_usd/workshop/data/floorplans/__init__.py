"""How a house is drawn: programme, cells on the middle lines of walls, then faces and openings.

Inside this package lengths are whole steps of sketch.STEP_M, so that walls two rooms share are
found by equality and never by tolerance.
"""
