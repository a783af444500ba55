"""The plan in a layout raster: rooms, doors, windows and passages under and between the items.

For rasters that come alone. Where the plan is known as vectors, those are used instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import LineString, Point

from chord_usd.errors import SceneError
from chord_usd.geometry import room_polygon
from chord_usd.graph.colours import CLEAR, SHADE_KINDS, LayoutPixels, read_pixels
from chord_usd.graph.detect import RoomProposal
from chord_usd.graph.faces import settle_faces
from chord_usd.palette import PLAN_CATEGORIES, ROOM_SHADES, category
from chord_usd.types import (
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    FloatArray,
    LayoutImage,
    Opening,
    OpeningKind,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.units import m_from_px, px_from_m
from chord_usd.vectorize import polygon_from_mask, rotated_box_from_mask

IntArray = npt.NDArray[np.int32]

BASE_AND_HEIGHT_M: dict[OpeningKind, tuple[float, float]] = {
    "door": (0.0, 2.1),
    "window": (0.9, 1.5),
    "passage": (0.0, 2.3),
}
"""A raster does not show heights; these are the usual ones."""

_LEAST_ROOM_M2 = 0.5
_LEAST_OPENING_M = 0.3
_STRAIGHT = 0.7
"""A straight bar fills so much of its rotated box; one round a corner does not."""
_WHITE = SHADE_KINDS.index("unknown")
_CLASSES = {row.name: row.detector_class for row in PLAN_CATEGORIES}
_SURE = 0.1
"""Least confidence times overlap with the room at which the network's word for it is taken."""


def bare_plan(layout: LayoutImage) -> PlanImage:
    """The plan raster under a layout: the same picture without its items."""
    pixels = read_pixels(layout.rgb)
    shades = np.array(list(ROOM_SHADES.values()), dtype=np.uint8)
    rgb = shades[pixels.shade]
    for name, label in _CLASSES.items():
        rgb[pixels.structure == label] = category(name).rgb
    rgb.setflags(write=False)
    return PlanImage(rgb, layout.frame)


def read_plan(pixels: LayoutPixels, frame: PixelFrame) -> Plan:
    """Rooms and openings. Raises SceneError when no enclosed floor is found.

    Rooms are told apart by walls, doors, windows, and by their shades where they touch; kinds come
    from the shades (name_rooms names white ones).
    """
    passages = _passages(pixels, frame)
    labels = _label_rooms(pixels, passages, frame)
    rooms = _rooms(labels, pixels, frame)
    if not rooms:
        raise SceneError(
            "no closed room was found in the layout",
            expected="floors enclosed by black walls",
            try_="chord-usd plan draw plan.json -o plan.png shows what a raster looks like",
        )
    bars: list[tuple[OpeningKind, BoolArray]] = []
    kinds: tuple[OpeningKind, ...] = ("door", "window")
    for kind in kinds:
        for mask in _parts(pixels.structure == _CLASSES[kind]):
            bars += [(kind, arm) for arm in _arms(mask, WALL_THICKNESS_M / frame.m_per_px)]
    bars += [("passage", mask) for mask in passages]
    openings = _openings(bars, rooms, frame)
    return Plan(tuple(rooms), tuple(openings))


def name_rooms(plan: Plan, proposals: Sequence[RoomProposal], frame: PixelFrame) -> Plan:
    """Give rooms of unknown kind the kind of the proposal that fits them best, if one fits."""
    rooms = tuple(
        replace(room, kind=_kind_of(room, proposals, frame)) if room.kind == "unknown" else room
        for room in plan.rooms
    )
    return replace(plan, rooms=rooms)


def _kind_of(room: Room, proposals: Sequence[RoomProposal], frame: PixelFrame) -> RoomKind:
    if not proposals:
        return room.kind
    floor = np.zeros(proposals[0].mask.shape, dtype=np.uint8)
    corners = np.rint((px_from_m(room.polygon_m, frame) - 0.5) * 16).astype(np.int32)
    cv2.fillPoly(floor, [corners], (1,), shift=4)
    inside = floor > 0
    votes: dict[RoomKind, float] = {}
    for proposal in proposals:
        both = (proposal.mask & inside).sum()
        overlap = float(both / max(1, (proposal.mask | inside).sum()))
        votes[proposal.kind] = max(votes.get(proposal.kind, 0.0), overlap * proposal.score)
    best = max(votes, key=lambda kind: votes[kind])
    return best if votes[best] >= _SURE else room.kind


def _passages(pixels: LayoutPixels, frame: PixelFrame) -> list[BoolArray]:
    """White bars as thin as a wall between shaded rooms."""
    white = (pixels.structure == CLEAR) & (pixels.shade == _WHITE)
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    found = []
    for mask in _parts(white):
        if _touches_border(mask):
            continue
        box = rotated_box_from_mask(mask)
        straight = mask.sum() > _STRAIGHT * box.length_px * box.width_px
        if straight and abs(box.width_px - thickness_px) <= 1.5 and box.length_px > box.width_px:
            found.append(mask)
    return found


def _label_rooms(
    pixels: LayoutPixels, passages: Sequence[BoolArray], frame: PixelFrame
) -> IntArray:
    """(H, W) number of each room, 0 elsewhere; slivers join the room beside them."""
    floor = pixels.structure == CLEAR
    for mask in passages:
        floor = floor & ~mask
    labels = np.zeros(floor.shape, dtype=np.int32)
    slivers = np.zeros(floor.shape, dtype=bool)
    least_px = _LEAST_ROOM_M2 / frame.m_per_px**2
    count = 0
    for shade in np.unique(pixels.shade[floor]):
        for mask in _parts(floor & (pixels.shade == shade)):
            if shade == _WHITE and _touches_border(mask):
                continue
            if mask.sum() < least_px:
                slivers |= mask
                continue
            count += 1
            labels[mask] = count
    return _filled(labels, slivers)


def _filled(labels: IntArray, slivers: BoolArray) -> IntArray:
    """Slivers, one pixel rim after the other, take the number of a room that they touch."""
    labels = labels.copy()
    kernel = np.ones((3, 3), dtype=np.uint8)
    while slivers.any():
        grown = cv2.dilate(labels.astype(np.float32), kernel).astype(np.int32)
        reached = slivers & (grown > 0)
        if not reached.any():
            break
        labels[reached] = grown[reached]
        slivers = slivers & ~reached
    return labels


def _rooms(labels: IntArray, pixels: LayoutPixels, frame: PixelFrame) -> list[Room]:
    """Rooms from top to bottom, left to right."""
    outlines = []
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    for label in range(1, int(labels.max()) + 1):
        mask = labels == label
        kind = SHADE_KINDS[int(np.bincount(pixels.shade[mask]).argmax())]
        outline = polygon_from_mask(mask)
        outlines.append((kind, settle_faces(outline, pixels.structure, thickness_px)))
    outlines.sort(key=lambda outline: tuple(outline[1].min(axis=0)[::-1]))
    counts: dict[str, int] = {}
    rooms = []
    for kind, polygon_px in outlines:
        name = "room" if kind == "unknown" else kind
        counts[name] = counts.get(name, 0) + 1
        polygon_m = frozen_array(m_from_px(polygon_px, frame))
        rooms.append(Room(f"{name}{counts[name]}", kind, polygon_m))
    return rooms


def _openings(
    bars: Sequence[tuple[OpeningKind, BoolArray]], rooms: Sequence[Room], frame: PixelFrame
) -> Iterator[Opening]:
    counts: dict[str, int] = {}
    for kind, mask in bars:
        box = rotated_box_from_mask(mask)
        if box.length_px * frame.m_per_px < _LEAST_OPENING_M:
            continue
        x, y = m_from_px(np.array(box.center_px), frame)
        base_m, height_m = BASE_AND_HEIGHT_M[kind]
        length_m = box.length_px * frame.m_per_px
        # Canvas angles run clockwise, yaw counter-clockwise.
        yaw_deg = -box.angle_deg % 180.0
        center, along_deg, joined = _in_wall(np.array([x, y]), yaw_deg, rooms)
        counts[kind] = counts.get(kind, 0) + 1
        yield Opening(
            f"{kind}{counts[kind]}",
            kind,
            Box((*center, base_m), (length_m, WALL_THICKNESS_M, height_m), along_deg),
            joined,
        )


def _arms(mask: BoolArray, thickness_px: float) -> list[BoolArray]:
    """The mask; or its two arms where it runs round a corner, as corner windows do."""
    box = rotated_box_from_mask(mask)
    if mask.sum() > _STRAIGHT * box.length_px * box.width_px:
        return [mask]
    reach = round(1.5 * thickness_px) + 1
    row = np.ones((1, reach), dtype=np.uint8)
    flat = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, row) > 0
    rest = mask & ~flat
    return [flat, rest] if flat.any() and rest.any() else [mask]


def _in_wall(
    center: FloatArray, yaw_deg: float, rooms: Sequence[Room]
) -> tuple[tuple[float, float], float, tuple[str, ...]]:
    """A bar's centre moved to the middle of its wall, the wall's direction, the rooms it joins."""
    sides = []
    for room in rooms:
        for start, stop in zip(room.polygon_m, np.roll(room.polygon_m, -1, axis=0), strict=True):
            along = float(np.degrees(np.arctan2(*(stop - start)[::-1]))) % 180.0
            apart = abs((along - yaw_deg + 90.0) % 180.0 - 90.0)
            distance = LineString([start, stop]).distance(Point(center))
            if apart < 15.0 and distance < 1.2 * WALL_THICKNESS_M:
                sides.append((distance, room, start, stop, along))
    if not sides:
        return (float(center[0]), float(center[1])), yaw_deg, ()
    sides.sort(key=lambda side: side[0])
    _, room, start, stop, along = sides[0]
    direction = (stop - start) / np.hypot(*(stop - start))
    outward = np.array([direction[1], -direction[0]])
    # From the wall's inner face, half its thickness out of the room.
    depth = float((center - start) @ outward)
    x, y = center + (WALL_THICKNESS_M / 2 - depth) * outward
    joined = dict.fromkeys(side[1].id for side in sides if _faces(side[1], room, outward, (x, y)))
    return (float(x), float(y)), along, tuple(joined)[:2]


def _faces(other: Room, room: Room, outward: FloatArray, center: tuple[float, float]) -> bool:
    """Whether a room is the one on this side of an opening or the one behind it."""
    if other is room:
        return True
    probe = Point(np.array(center) + outward * 0.75 * WALL_THICKNESS_M)
    return room_polygon(other).distance(probe) < 0.1


def _parts(mask: BoolArray) -> Iterator[BoolArray]:
    """4-connected parts of a mask."""
    count, labels = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)
    for label in range(1, count):
        yield labels == label


def _touches_border(mask: BoolArray) -> bool:
    return bool(mask[0].any() or mask[-1].any() or mask[:, 0].any() or mask[:, -1].any())
