"""A drawing's rooms and openings by what a network sees on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    ByteArray,
    FloatArray,
    Opening,
    PixelFrame,
)
from chord_usd.line.plan.fitted import Fit
from chord_usd.line.plan.openings import openings_of
from chord_usd.line.plan.regions import Outline, Regions, find_regions, room_outlines
from chord_usd.line.plan.scale_choice import USUAL_DOOR_M
from chord_usd.line.plan.segment import Segments
from chord_usd.line.plan.wall_openings import WallOpening, find_openings

_SHORTEST_M = {"door": 0.45, "passage": 0.45, "window": 0.3}

_FRONT_DOOR_M = 0.9
_SURE_DOOR = 0.5
"""Chance from which a door speaks for the scale."""


class Reader(Protocol):
    """Whoever sees what is built on a page, such as segment.PageReader."""

    def read(self, rgb: ByteArray) -> Segments:
        """See a picture, (H, W, 3)."""
        ...


@dataclass(frozen=True, eq=False)
class SeenReading:
    """What was seen on a page."""

    segments: Segments
    regions: Regions
    outlines: list[Outline]
    openings: list[WallOpening]
    frame: PixelFrame
    joined: int = 0
    """How many floors became parts of others, since nothing parts them."""

    @property
    def polygons_px(self) -> list[FloatArray]:
        """(N, 2) corners of each room."""
        return [outline.polygon_px for outline in self.outlines]

    @property
    def doors_m_per_px(self) -> float | None:
        """By the usual inner door; None where too few are seen."""
        doors = [o for o in self.openings if o.kind == "door" and len(o.rooms) == 2]
        lengths = [door.length_px for door in doors if door.confidence >= _SURE_DOOR]
        return USUAL_DOOR_M / float(np.median(lengths)) if len(lengths) > 1 else None

    @property
    def entrance_m_per_px(self) -> float | None:
        """By the usual front door, the narrowest outer one; None where none is seen."""
        doors = [o for o in self.openings if o.kind == "door" and len(o.rooms) == 1]
        lengths = [door.length_px for door in doors if door.confidence >= _SURE_DOOR]
        return _FRONT_DOOR_M / min(lengths) if lengths else None

    def of(self, rooms: Sequence[int]) -> SeenReading:
        """Of these rooms alone, by index."""
        numbers = {room: number for number, room in enumerate(rooms)}
        openings = [
            replace(o, rooms=tuple((numbers[room], normal) for room, normal in o.rooms))
            for o in self.openings
            if all(room in numbers for room, _ in o.rooms)
        ]
        outlines = [self.outlines[room] for room in rooms]
        return replace(self, outlines=outlines, openings=openings)

    def with_fit(self, fit: Fit) -> SeenReading:
        """With walls and openings where they were moved to."""
        pairs = zip(self.outlines, fit.polygons_px, strict=True)
        outlines = [replace(outline, polygon_px=polygon) for outline, polygon in pairs]
        return replace(self, outlines=outlines, openings=fit.openings)

    def again(self, m_per_px: float) -> SeenReading:
        """At another scale, which changes what is large enough for a room."""
        read = _opened(self.segments, self.regions, replace(self.frame, m_per_px=m_per_px))
        return replace(read, joined=self.joined)

    def with_joined(self, regions: Regions, count: int) -> SeenReading:
        """With so many floors joined to others, at the same scale."""
        read = _opened(self.segments, regions, self.frame)
        return replace(read, joined=self.joined + count)

    def placed(self, room_ids: Sequence[str], frame: PixelFrame) -> tuple[Opening, ...]:
        """The openings in the walls of rooms."""
        wide = [o for o in self.openings if o.length_px * frame.m_per_px > _SHORTEST_M[o.kind]]
        return openings_of(wide, room_ids, frame)


def read_seen(segments: Segments, given: float | None) -> SeenReading:
    """Rooms and openings of what was seen. given: metres per pixel, where known."""
    regions = find_regions(segments)
    m_per_px = given or WALL_THICKNESS_M / max(regions.thickness_px, 1.0)
    return _opened(segments, regions, PixelFrame(m_per_px, (0.0, 0.0), segments.built.shape[1]))


def _opened(segments: Segments, regions: Regions, frame: PixelFrame) -> SeenReading:
    """Rooms at a scale, and the openings between them."""
    outlines = room_outlines(regions, segments, frame.m_per_px)
    polygons = [outline.polygon_px for outline in outlines]
    openings = find_openings(polygons, segments, regions.thickness_px)
    return SeenReading(segments, regions, outlines, openings, frame)
