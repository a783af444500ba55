"""The largest houses that are taken on, and the ranges of numbers that users choose. Without
imports: the command line has it too.

Every step grows with what a house holds, some of it faster than linearly; and a file with more is
as good as never a house, but a wrong unit, a whole town, or made to keep a machine busy.
"""

LARGEST_HOUSE_M = 500.0
"""From one side to the other. Hardly a building is longer in one piece, and at the coarsest scale
that layouts are drawn at not much more fits the largest canvas (canvas.LARGEST_CANVAS_PX)."""

FARTHEST_M = 1e5
"""From the origin of a file's coordinates, metres, and of pixels of traced plans."""

M_PER_PX = (1e-4, 10.0)
"""Range of a picture's scale, metres per pixel, and of metres per unit of a vector file: from a
tenth of a millimetre to a map on which a whole house is a dot."""

MOST_ROOMS = 500
"""Written and checked in 53 s of processor time and 1 GB, with 1,000 pieces."""

MOST_CORNERS = 1000
"""Of one room; each of its walls is a mesh."""

MOST_CORNERS_IN_ALL = 20_000

MOST_FLOOR_TRIANGLES = 5000
"""Of the floors of a house, as others' data sets have them: they are joined into outlines."""

MOST_OPENINGS = 10_000
"""Doors, windows and passages."""

MOST_ITEMS = 10_000
"""Pieces of furniture, and what lies on them."""

MOST_JSON_BYTES = 32 * 2**20
"""Of a CHOrD JSON file: MOST_ITEMS take half as much."""

SEEDS = (0, 2**31 - 1)
"""Blender and USD count with 32 bits."""

STEPS = (1, 1000)
"""Of samplers: the models were trained with so many; there are no further levels of noise."""

PARTS = (1, 1000)
"""Plans of a sheet, storeys of a file."""

MOST_STOREYS = 12
"""Of one house: its walls and rooms suit houses, not towers."""

MOST_STAIRS = 100
"""On one storey."""

REDRAWS = (0, 100)

TEXTURE_PX = (256, 4096)
"""Side of the textures of floors and walls."""
