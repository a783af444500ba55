"""The public block of a house: living room, dining room and kitchen beside a corridor."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.programme import Programme, floor_area
from chord_usd.workshop.data.floorplans.sketch import WALL, Point, Sketch, rectangle, tidy

_LEAST_KITCHEN = 195
_LEAST_DINING = 290
_WIDE_DINING = 300
"""What a dining room would like to be wide: a table, chairs on both sides, and a way past."""

_NECK = 150
"""Least width of the part of a living room that runs past the kitchen."""


@dataclass(frozen=True)
class Block:
    """Measures of a public block at x in [-width, 0]; the corridor is at y in [0, breadth]."""

    width: int
    bottom: int
    top: int
    breadth: int
    two_sided: bool
    """Whether a second corridor leaves it to the west."""


def draw_public_block(dice: Dice, programme: Programme, block: Block) -> Sketch:
    """Living room to the south, kitchen to the north, dining room (if any) between them."""
    kitchen_area = floor_area(dice, "kitchen")
    if not programme.dining:
        return _living_and_kitchen(dice, block, kitchen_area)
    if not block.two_sided and dice.chance(0.2):
        return _side_by_side(dice, block, kitchen_area)
    return _in_a_row(dice, block, kitchen_area)


def _living_and_kitchen(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    sketch = Sketch()
    deep = int(kitchen_area / (block.width - WALL)) + WALL
    if deep < _LEAST_KITCHEN or dice.chance(0.4):
        # In a corner that the living room runs past.
        edge = max(block.top - 270, block.breadth)
        wanted = kitchen_area / (block.top - edge - WALL) + WALL
        right = int(min(max(wanted, _LEAST_KITCHEN), block.width - _NECK)) - block.width
        corners: list[Point] = [
            (-block.width, block.bottom), (0, block.bottom), (0, block.top), (right, block.top),
            (right, edge), (-block.width, edge),
        ]  # fmt: skip
    else:
        edge, right = max(block.top - deep, block.breadth), 0
        corners = rectangle(-block.width, block.bottom, 0, edge)
    living = sketch.add("living", tidy(corners))
    kitchen = sketch.add("kitchen", rectangle(-block.width, edge, right, block.top))
    if dice.chance(0.2):
        sketch.open_pairs.append((living, kitchen))
    return sketch


def _in_a_row(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    """Living, dining, kitchen one after the other, or the kitchen west of the dining room."""
    sketch = Sketch()
    # A west corridor would end in a kitchen west of the dining room: it ends in the living room.
    low = block.breadth if block.two_sided else dice.pick([0, dice.steps(-80, -30), block.breadth])
    living = sketch.add("living", rectangle(-block.width, block.bottom, 0, low))
    deep = max(int(kitchen_area / (block.width - WALL)) + WALL, _LEAST_KITCHEN)
    edge = block.top - deep
    if edge - low < _LEAST_DINING or dice.chance(0.4):
        wanted = kitchen_area / (block.top - low - WALL) + WALL
        widest = max(block.width - _WIDE_DINING, min(_LEAST_KITCHEN, block.width - 240))
        right = int(min(max(wanted, _LEAST_KITCHEN), widest)) - block.width
        dining = sketch.add("dining", rectangle(right, low, 0, block.top))
        kitchen = sketch.add("kitchen", rectangle(-block.width, low, right, block.top))
    else:
        dining = sketch.add("dining", rectangle(-block.width, low, 0, edge))
        kitchen = sketch.add("kitchen", rectangle(-block.width, edge, 0, block.top))
    if dice.chance(0.7):
        sketch.open_pairs.append((living, dining))
    if dice.chance(0.2):
        sketch.open_pairs.append((dining, kitchen))
    return sketch


def _side_by_side(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    """The dining room between the living room and the corridor, the kitchen north of it."""
    sketch = Sketch()
    eat = dice.steps(270, 340)
    left = -eat - dice.steps(370, 480)
    bottom = dice.pick([block.bottom, dice.steps(-120, -40)])
    edge = block.top - max(int(kitchen_area / (eat - WALL)) + WALL, _LEAST_KITCHEN)
    edge = max(edge, block.breadth, bottom + _LEAST_DINING)
    dining = sketch.add("dining", rectangle(-eat, bottom, 0, edge))
    kitchen = sketch.add("kitchen", rectangle(-eat, edge, 0, max(block.top, edge + 200)))
    top = dice.pick([edge, kitchen.bounds[3], edge - dice.steps(40, 90)])
    living = sketch.add("living", rectangle(left, block.bottom, -eat, top))
    if dice.chance(0.8):
        sketch.open_pairs.append((living, dining))
    if top != edge and dice.chance(0.25):
        # Where all three meet in a corner of the outline, it would have no wall to stand in.
        sketch.open_pairs.append((dining, kitchen))
    return sketch
