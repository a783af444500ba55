"""LayoutImage -> SceneGraph, the whole step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Protocol

import cv2
import numpy as np

from chord_usd.base.metrics.rooms import empty_rooms
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import BACKGROUND_RGB
from chord_usd.base.scene.room_areas import plausibility
from chord_usd.base.scene.types import (
    CANVAS_PX,
    ByteArray,
    Detection,
    FloatArray,
    LayoutImage,
    PixelFrame,
    Plan,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.graph.colours import LayoutPixels, read_pixels
from chord_usd.line.graph.detect import (
    ItemDetector,
    RoomProposal,
    RoomSegmenter,
    load_item_detector,
    load_room_segmenter,
)
from chord_usd.line.graph.directions import plan_directions
from chord_usd.line.graph.match import place_items
from chord_usd.line.graph.snap import find_items


class Detector(Protocol):
    """Proposes items; detect.ItemDetector is one."""

    def detect(self, rgb: ByteArray) -> list[Detection]:
        """Oriented boxes in a layout raster."""


class Segmenter(Protocol):
    """Proposes rooms; detect.RoomSegmenter is one."""

    def segment(self, rgb: ByteArray) -> list[RoomProposal]:
        """Masks in a layout raster."""


def extract_graph(
    layout: LayoutImage,
    plan: Plan | None = None,
    detector: Detector | None = None,
    segmenter: Segmenter | None = None,
    pixels: LayoutPixels | None = None,
) -> SceneGraph:
    """The scene graph of a layout raster: pieces stand where they are painted, without meshes.

    plan: its rooms and openings are taken as they are; without it they are read from the raster.
    Rooms of unknown kind are named by the segmenter, if something of that kind stands there; a home
    that has a kitchen gets no second one so.
    detector, segmenter: the shipped networks by default, loaded when needed. pixels: of the layout,
    where they were read before. Raises CheckpointError when they cannot be, SceneError when there
    is no room.
    """
    pixels = pixels or read_pixels(layout.rgb)
    proposals = detect_in_tiles((detector or _shipped_detector()).detect, layout.rgb)
    if plan is None:
        from chord_usd.line.graph.layout_plan import read_plan

        plan = read_plan(pixels, layout.frame)
    nameless = {room.id for room in plan.rooms if room.kind == "unknown"}
    if nameless:
        plan = name_in_tiles((segmenter or _shipped_segmenter()).segment, plan, layout)
    directions = plan_directions(plan.rooms, layout.frame)
    if pixels.clean or not proposals:
        detected = find_items(pixels, layout.frame.m_per_px, directions, proposals)
    else:
        from chord_usd.line.graph.network_items import find_foreign_items

        m_per_px = layout.frame.m_per_px
        detected = find_foreign_items(pixels, layout.rgb, m_per_px, directions, proposals)
    items = place_items(detected, plan.rooms, layout.frame)
    graph = replace(plan.scene(), items=items, provenance=layout.provenance)
    kinds = {room.kind for room in graph.rooms if room.id not in nameless}
    again = [room.id for room in graph.rooms if room.kind == "kitchen" in kinds]
    bare = nameless.intersection((*empty_rooms(graph), *again))
    rooms = (replace(room, kind="unknown") if room.id in bare else room for room in graph.rooms)
    return replace(graph, rooms=tuple(rooms)) if bare else graph


@lru_cache(maxsize=1)
def _shipped_detector() -> ItemDetector:
    return load_item_detector()


@lru_cache(maxsize=1)
def _shipped_segmenter() -> RoomSegmenter:
    return load_room_segmenter()


# Layout rasters larger than the detectors look at, tile by tile ----------------------------------

# Tiles overlap by twice HALO_PX; what is seen in two counts where its middle lies in the tile's
# core, and cores part the raster. Pieces are shorter than twice the halo, so that each is whole
# in the tile that counts.

HALO_PX = 48
"""At the coarsest scale of a plan, 3.4 m."""

_CORE_PX = CANVAS_PX - 2 * HALO_PX

_SURE = 0.1
"""Least confidence times overlap with the room at which the network's word for it is taken."""


@dataclass(frozen=True, eq=False)
class Tile:
    """A square of a raster."""

    rgb: ByteArray
    """(CANVAS_PX, CANVAS_PX, 3)."""
    corner_px: tuple[int, int]
    """x and y of its upper left corner in the raster."""
    core_px: tuple[tuple[float, float], tuple[float, float]]
    """From and to, x then y: what counts in this tile. Infinite at the raster's edges."""

    def counts(self, point_px: FloatArray) -> bool:
        """Whether a point (2,) of the raster is this tile's."""
        return all(low <= at < high for at, (low, high) in zip(point_px, self.core_px, strict=True))


def tiles_of(rgb: ByteArray) -> Iterator[Tile]:
    """The tiles of a square raster (H, H, 3) on which something is drawn, H >= CANVAS_PX.

    A raster of CANVAS_PX is its own only tile.
    """
    spans = list(_spans(rgb.shape[0]))
    for top, rows in spans:
        for left, columns in spans:
            part = rgb[top : top + CANVAS_PX, left : left + CANVAS_PX]
            if len(spans) == 1 or (part != BACKGROUND_RGB).any():
                yield Tile(part, (left, top), (columns, rows))


def _spans(side_px: int) -> Iterator[tuple[int, tuple[float, float]]]:
    """Where tiles begin along a side, and their cores."""
    last = side_px - CANVAS_PX
    count = 1 + max(0, -(-last // _CORE_PX))
    edges = [-np.inf, *(index * _CORE_PX + HALO_PX for index in range(1, count)), np.inf]
    for index in range(count):
        yield min(index * _CORE_PX, last), (edges[index], edges[index + 1])


def detect_in_tiles(
    detect: Callable[[ByteArray], Sequence[Detection]], rgb: ByteArray
) -> list[Detection]:
    """Proposals for a layout raster of any size, in its pixels."""
    detections = []
    for tile in tiles_of(rgb):
        for detection in detect(tile.rgb):
            corners_px = detection.corners_px + tile.corner_px
            if tile.counts(corners_px.mean(axis=0)):
                detections.append(replace(detection, corners_px=frozen_array(corners_px)))
    return detections


def name_in_tiles(
    segment: Callable[[ByteArray], Sequence[RoomProposal]], plan: Plan, layout: LayoutImage
) -> Plan:
    """The plan with its rooms of unknown kind named by what is seen of them in their tile."""
    frame = layout.frame
    named = {room.id: room for room in plan.rooms}
    for tile in tiles_of(layout.rgb):
        rooms = tuple(
            room
            for room in plan.rooms
            if room.kind == "unknown" and tile.counts(px_from_m(room.polygon_m, frame).mean(axis=0))
        )
        if rooms:
            seen = name_rooms(Plan(rooms, ()), segment(tile.rgb), _frame_of(tile, frame))
            named.update((room.id, room) for room in seen.rooms)
    return replace(plan, rooms=tuple(named[room.id] for room in plan.rooms))


def _frame_of(tile: Tile, frame: PixelFrame) -> PixelFrame:
    left, top = tile.corner_px
    below_px = frame.height_px - top - CANVAS_PX
    x_m, y_m = frame.origin_m
    origin_m = (x_m + left * frame.m_per_px, y_m + below_px * frame.m_per_px)
    return PixelFrame(frame.m_per_px, origin_m, CANVAS_PX)


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
    inside, area_m2 = floor > 0, room_polygon(room).area
    votes: dict[RoomKind, float] = {}
    for proposal in proposals:
        both = (proposal.mask & inside).sum()
        overlap = float(both / max(1, (proposal.mask | inside).sum()))
        vote = overlap * proposal.score * plausibility(proposal.kind, area_m2)
        votes[proposal.kind] = max(votes.get(proposal.kind, 0.0), vote)
    best = max(votes, key=lambda kind: votes[kind])
    return best if votes[best] >= _SURE else room.kind
