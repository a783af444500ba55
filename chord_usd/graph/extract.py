"""LayoutImage -> SceneGraph, the whole step."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache
from typing import Protocol

from chord_usd.graph.arrange import Seen, arrange
from chord_usd.graph.colours import read_pixels
from chord_usd.graph.detect import (
    ItemDetector,
    RoomProposal,
    RoomSegmenter,
    load_item_detector,
    load_room_segmenter,
)
from chord_usd.graph.directions import plan_directions
from chord_usd.graph.match import Database, match_assets, place_items
from chord_usd.graph.rooms import read_plan
from chord_usd.graph.snap import find_items
from chord_usd.graph.tiles import detect_in_tiles, name_in_tiles
from chord_usd.scene.types import ByteArray, Detection, LayoutImage, Plan, SceneGraph


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
    database: Database | None = None,
    detector: Detector | None = None,
    segmenter: Segmenter | None = None,
    without: Collection[str] = (),
) -> SceneGraph:
    """The scene graph of a layout raster.

    plan: its rooms and openings are taken as they are; without it they are read from the raster.
    Rooms of unknown kind are named by the segmenter. database: gives each item its mesh; without
    it items have none. detector, segmenter: the shipped networks by default, loaded when needed.
    without: names of arrange.RULES; without all of them, pieces stand where they are painted.
    Raises CheckpointError when they cannot be, SceneError when there is no room, AssetError.
    """
    pixels = read_pixels(layout.rgb)
    proposals = detect_in_tiles((detector or _shipped_detector()).detect, layout.rgb)
    plan = plan or read_plan(pixels, layout.frame)
    if any(room.kind == "unknown" for room in plan.rooms):
        plan = name_in_tiles((segmenter or _shipped_segmenter()).segment, plan, layout)
    directions = plan_directions(plan.rooms, layout.frame)
    found = find_items(pixels, layout.frame.m_per_px, directions, proposals)
    items = place_items(found, plan.rooms, layout.frame)
    graph = replace(plan.scene(), items=items, provenance=layout.provenance)
    graph = arrange(graph, Seen(pixels.item, layout.frame), without)
    return match_assets(graph, database) if database else graph


@lru_cache(maxsize=1)
def _shipped_detector() -> ItemDetector:
    return load_item_detector()


@lru_cache(maxsize=1)
def _shipped_segmenter() -> RoomSegmenter:
    return load_room_segmenter()
