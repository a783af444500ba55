"""Two rooms that were painted as one."""

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import bubbles_of
from chord_usd.base.scene.geometry import is_axis_aligned
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.base.scene.wish import room_counts
from chord_usd.line.planning.divide import Seed, divided
from chord_usd.line.planning.faults import faults
from chord_usd.line.planning.outline import open_shell, shell_labels
from chord_usd.line.planning.partition import plan_from_labels
from chord_usd.workshop.data.houses import random_plan


def spot(width: int = 40, height: int = 20) -> np.ndarray:
    mask = np.zeros((60, 60), bool)
    mask[10 : 10 + height, 10 : 10 + width] = True
    return mask


LEFT, RIGHT = Seed(20, 20, 4.0), Seed(40, 20, 4.0)


def test_one_room_stays_whole() -> None:
    (whole,) = divided(spot(), [LEFT], 50)
    assert (whole == spot()).all()


def test_without_a_wall_it_is_divided_halfway() -> None:
    left, right = divided(spot(), [LEFT, RIGHT], 50)
    assert left[20, 20]
    assert right[20, 40]
    assert not (left & right).any()
    assert left.sum() == right.sum() + 20, "the wall stands at 30, the spot from 10 to 50"


def test_a_large_bubble_has_the_larger_part() -> None:
    left, right = divided(spot(), [replace(LEFT, radius_px=8.0), RIGHT], 50)
    assert left.sum() > right.sum() + 100


def test_a_broken_wall_is_closed() -> None:
    mask = spot()
    mask[14:26, 24] = False
    left, _ = divided(mask, [LEFT, RIGHT], 50)
    assert np.flatnonzero(left.any(axis=0)).max() == 23


def test_what_is_too_small_for_two_stays_one() -> None:
    assert len(divided(spot(), [LEFT, RIGHT], 450)) == 1


def test_three_rooms() -> None:
    seeds = [Seed(16, 20, 3.0), Seed(30, 20, 3.0), Seed(44, 20, 3.0)]
    parts = divided(spot(), seeds, 50)
    assert [int(sum(part[s.row, s.column] for part in parts)) for s in seeds] == [1, 1, 1]
    assert len(parts) == 3


def square(x: float, width: float) -> np.ndarray:
    return frozen_array([(x, 0.0), (x + width, 0.0), (x + width, 4.0), (x, 4.0)])


def test_two_bubbles_make_two_rooms_of_what_was_painted_as_one() -> None:
    rooms = (
        Room("bedroom1", "bedroom", square(0.0, 3.5)),
        Room("bedroom2", "bedroom", square(3.74, 3.5)),
    )
    front = Opening("door1", "door", Box((1.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("bedroom1",))
    two = Plan(rooms, (front,))
    one = Plan((Room("bedroom1", "bedroom", square(0.0, 7.24)),), (front,))
    frame = plan_labels.label_frame(one, 0.12)
    labels = plan_labels.label_plan(one, frame)
    assert room_counts(plan_from_labels(labels, frame))["bedroom"] == 1
    found = plan_from_labels(labels, frame, None, bubbles_of(two))
    assert room_counts(found)["bedroom"] == 2
    assert faults(found) == [], "and a door leads from one to the other"


SLANTED = [
    plan
    for seed in range(120)
    if not is_axis_aligned(plan := random_plan(np.random.default_rng(seed)))
    and plan_labels.fitting_scale(plan)
]


@pytest.mark.parametrize("plan", SLANTED[:8])
def test_slanted_walls_of_a_shell_stay_and_so_do_their_windows(plan: Plan) -> None:
    """Whatever the rooms are, here one that fills most of it, its bays left to nobody."""
    shell = open_shell(plan)
    labels, frame = shell_labels(shell)
    painted = np.where(
        labels == plan_labels.label_of("unknown"), plan_labels.label_of("living"), labels
    )
    columns = np.flatnonzero((painted == plan_labels.label_of("living")).any(axis=0))
    painted[:, columns[: len(columns) // 8]] = plan_labels.WALL
    found = plan_from_labels(painted.astype(np.uint8), frame, shell)
    assert all(opening.room_ids for opening in found.openings)
    area = sum(abs(_area(room.polygon_m)) for room in found.rooms)
    assert area == pytest.approx(abs(_area(shell.rooms[0].polygon_m)), rel=2e-3)


def _area(polygon_m: np.ndarray) -> float:
    x, y = polygon_m.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2)
