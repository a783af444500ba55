"""LayoutImage -> SceneGraph, the whole step."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Protocol

from chord_usd.base.metrics.rooms import empty_rooms
from chord_usd.base.scene.types import ByteArray, Detection, LayoutImage, Plan, SceneGraph
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
from chord_usd.line.graph.tiles import detect_in_tiles, name_in_tiles


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
    Rooms of unknown kind are named by the segmenter, if something of that kind stands there.
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
        found = find_items(pixels, layout.frame.m_per_px, directions, proposals)
    else:
        from chord_usd.line.graph.network_items import find_foreign_items

        m_per_px = layout.frame.m_per_px
        found = find_foreign_items(pixels, layout.rgb, m_per_px, directions, proposals)
    items = place_items(found, plan.rooms, layout.frame)
    graph = replace(plan.scene(), items=items, provenance=layout.provenance)
    bare = nameless.intersection(empty_rooms(graph))
    rooms = (replace(room, kind="unknown") if room.id in bare else room for room in graph.rooms)
    return replace(graph, rooms=tuple(rooms)) if bare else graph


@lru_cache(maxsize=1)
def _shipped_detector() -> ItemDetector:
    return load_item_detector()


@lru_cache(maxsize=1)
def _shipped_segmenter() -> RoomSegmenter:
    return load_room_segmenter()
