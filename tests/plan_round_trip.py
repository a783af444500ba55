"""Draw a random house, decode it, and compare: shared by the quick and the thorough test."""

from __future__ import annotations

from collections import Counter

import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import footprint, footprint_polygon, polygons_of, room_polygon
from chord_usd.base.scene.types import BASE_AND_HEIGHT_M, Opening, Plan, RoomKind
from chord_usd.line.plan.decode import decode_plan
from chord_usd.workshop.data.houses import random_plan

HALF_PX = 0.5
SLANTED_PX = 0.8
"""A wall that slants by a single pixel may be taken for one with a jog."""

HALF_DIAGONAL_PX = HALF_PX * np.sqrt(2) + 1e-6


def expected_rooms(plan: Plan) -> list[tuple[RoomKind, Polygon]]:
    """The rooms as a raster can show them: those of one kind that touch are one."""
    found = []
    for kind in sorted({room.kind for room in plan.rooms}):
        rooms = [room_polygon(room).buffer(1e-9) for room in plan.rooms if room.kind == kind]
        found += [(kind, part) for part in polygons_of(shapely.union_all(rooms))]
    return found


def assert_decoded(plan: Plan, decoded: Plan, m_per_px: float) -> None:
    wanted = expected_rooms(plan)
    assert Counter(kind for kind, _ in wanted) == Counter(room.kind for room in decoded.rooms)
    for kind, shape in wanted:
        found = max(decoded.rooms, key=lambda r: room_polygon(r).intersection(shape).area)
        assert found.kind == kind
        assert room_polygon(found).is_valid
        strayed = room_polygon(found).exterior.hausdorff_distance(shape.exterior) / m_per_px
        assert strayed <= (HALF_DIAGONAL_PX if is_upright(shape) else SLANTED_PX)
    if some_merge(plan, m_per_px):
        return
    kinds = Counter(opening.kind for opening in plan.openings)
    assert kinds == Counter(opening.kind for opening in decoded.openings)
    for opening in plan.openings:
        assert_opening(opening, plan, decoded, m_per_px)


def is_upright(shape: Polygon) -> bool:
    edges = np.diff(np.asarray(shape.exterior.coords), axis=0)
    return bool((np.abs(edges).min(axis=1) < 1e-6).all())


def some_merge(plan: Plan, m_per_px: float) -> bool:
    """Whether two openings of one kind lie so close that no pixel need part them."""
    shapes = [(opening.kind, footprint_polygon(opening.box)) for opening in plan.openings]
    return any(
        kind == other_kind and shape.distance(other) < m_per_px
        for index, (kind, shape) in enumerate(shapes)
        for other_kind, other in shapes[:index]
    )


def assert_opening(opening: Opening, plan: Plan, decoded: Plan, m_per_px: float) -> None:
    same_kind = [other for other in decoded.openings if other.kind == opening.kind]
    center = np.array(opening.box.center_m[:2])
    found = min(same_kind, key=lambda o: np.hypot(*(np.array(o.box.center_m[:2]) - center)))
    corners, wanted = footprint(found.box), footprint(opening.box)
    strayed = np.abs(corners[:, None] - wanted).max(axis=2).min(axis=0).max() / m_per_px
    slanted = opening.box.yaw_deg % 90.0 != 0.0
    # In a slanted wall nothing but a few stepped pixels tells where an opening ends.
    assert strayed <= (1.2 if slanted else HALF_PX + 1e-6)
    assert len(found.room_ids) == len(opening.room_ids)
    assert {decoded.room(i).kind for i in found.room_ids} == {
        plan.room(i).kind for i in opening.room_ids
    }
    assert (found.box.center_m[2], found.box.size_m[2]) == BASE_AND_HEIGHT_M[opening.kind]


def assert_round_trip(seed: int) -> int:
    """Check one random house; returns how many pixels differ when it is drawn again."""
    plan = random_plan(np.random.default_rng(seed))
    image = canvas.draw_plan(plan)
    decoded = decode_plan(image)
    assert_decoded(plan, decoded, image.frame.m_per_px)
    again = canvas.draw_plan(decoded, image.frame)
    return int((again.rgb != image.rgb).any(axis=2).sum())
