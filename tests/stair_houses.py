"""Houses of two storeys with one room each and a stair, or a picture of one, in its corner."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.json_stairs import stair_to_json
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.stair_places import DRAWN_STAIRS
from chord_usd.base.scene.storeys import STAIRS, Building, Stair, StairForm, StoreyPlan, Turn
from chord_usd.base.scene.types import Box, Opening, Plan, Room

SIDE_M = 7.0


def cornered(form: StairForm, size_m: tuple[float, float], turn: Turn = "right") -> Building:
    """A stair in the north-western corner of a square hall; a straight one ends before the wall."""
    north = SIDE_M - (1.5 if form == "straight" else 0.0)
    box = Box((size_m[0] / 2, north - size_m[1] / 2, 0.0), (*size_m, 1.0), 0.0)
    square = np.array([[0.0, 0.0], [SIDE_M, 0.0], [SIDE_M, SIDE_M], [0.0, SIDE_M]])
    door = Opening("door", "door", Box((6.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("hall",))
    storeys = []
    for index, leads in enumerate(("up", "down")):
        shown = stair_to_json(Stair(f"stair{index}", form, box, turn, leads))  # type: ignore[arg-type]
        rooms = (Room("hall", "corridor", square),)
        openings = (door,) if index == 0 else ()
        storeys.append(StoreyPlan(Plan(rooms, openings, {STAIRS: [shown]})))
    return stack(storeys)


def terraced() -> list[StoreyPlan]:
    """An English terraced house: flights 2.7 m long are drawn on both storeys, between walls."""
    hall = np.array([[0.0, 0.0], [2.1, 0.0], [2.1, 4.2], [1.2, 4.2], [1.2, 1.1], [1.1, 1.1],
                     [1.1, 4.2], [0.0, 4.2]])  # fmt: skip
    sitting = np.array([[0.0, 4.34], [2.1, 4.34], [2.1, 8.0], [0.0, 8.0]])
    landing = np.array([[0.0, 4.4], [1.2, 4.4], [1.2, 1.68], [2.1, 1.68], [2.1, 6.4], [0.0, 6.4]])
    doors = (
        Opening("front", "door", Box((0.6, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("hall",)),
        Opening("inner", "door", Box((0.55, 4.27, 0.0), (0.8, 0.24, 2.1), 0.0), ("hall", "sit")),
    )
    drawn = [[(1.2, 1.5), (2.1, 1.5), (2.1, 4.2), (1.2, 4.2)],
             [(1.22, 1.7), (2.09, 1.7), (2.09, 4.4), (1.22, 4.4)]]  # fmt: skip
    cm = [[[100.0 * x, 100.0 * y] for x, y in ring] for ring in drawn]
    ground = Plan(
        (Room("hall", "corridor", hall), Room("sit", "living", sitting)), doors,
        {DRAWN_STAIRS: [cm[0]]},
    )  # fmt: skip
    first = Plan((Room("landing", "unknown", landing),), (), {DRAWN_STAIRS: [cm[1]]})
    return [StoreyPlan(ground), StoreyPlan(first, shift_m=(0.0, 0.0))]
