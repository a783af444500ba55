"""The artefacts that travel along the line: Plan, PlanImage, LayoutImage, SceneGraph, StageFile.

Numpy and the standard library only. Lengths are metres, angles degrees counter-clockwise from +x,
Z is up. Everything is frozen; arrays have their write flag cleared. Centimetres exist only inside
the CHOrD JSON reader and writer.

An item's own frame has its origin at the centre of its underside, length along x, width (depth)
along y, and its front towards -y. At yaw 0 a sofa's back is therefore to the north (+y).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
ByteArray = npt.NDArray[np.uint8]
BoolArray = npt.NDArray[np.bool_]

RoomKind = Literal[
    "living", "dining", "bedroom", "kitchen", "bathroom", "balcony",
    "corridor", "study", "store", "unknown", "washroom", "wc",
]  # fmt: skip
ROOM_KINDS: tuple[RoomKind, ...] = RoomKind.__args__  # type: ignore[attr-defined]

WET_KINDS: tuple[RoomKind, ...] = ("bathroom", "washroom", "wc")
"""Rooms with a bath or shower; for the laundry, with a basin; with a toilet and a basin."""
LEARNED_KINDS: tuple[RoomKind, ...] = tuple(
    kind for kind in ROOM_KINDS if kind not in WET_KINDS or kind == "bathroom"
)
"""Classes of networks, and kinds that rasters shade: weights depend on their order."""


def learned_kind(kind: RoomKind) -> RoomKind:
    """The class that networks know a room by: all wet rooms are bathrooms."""
    return "bathroom" if kind in WET_KINDS else kind


OpeningKind = Literal["door", "window", "passage"]

BASE_AND_HEIGHT_M: dict[OpeningKind, tuple[float, float]] = {
    "door": (0.0, 2.1),
    "window": (0.9, 1.5),
    "passage": (0.0, 2.3),
}
"""Heights of a hole's lower edge and of the hole itself, where a raster does not show them."""

WALL_THICKNESS_M = 0.24
"""Every wall of a plan raster is this thick, which is what gives the raster its scale (paper)."""

ROOM_HEIGHT_M = 2.7
"""From floor to ceiling, in every room."""

CANVAS_PX = 256
"""Width and height of plan and layout rasters (paper, section 5); rasters of large houses
are larger (canvas.house_frame)."""


def frozen_array(values: npt.ArrayLike, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """A copy of values that cannot be written to."""
    array = np.array(values, dtype=dtype)
    array.setflags(write=False)
    return array


OPEN = "openM"
"""Key of Room.extra: metres of its outline with nothing between it and the outside, where that is
more than a door."""

SURROUNDS = "surroundsM2"
"""Key of a room's extra: square metres that walls within it take up, which are no room."""


@dataclass(frozen=True)
class PixelFrame:
    """Where a raster lies in the world. units.px_from_m and units.m_from_px do the arithmetic."""

    m_per_px: float
    origin_m: tuple[float, float]
    """World position of the lower left corner of the lower left pixel."""
    height_px: int = CANVAS_PX


@dataclass(frozen=True)
class Box:
    """An oriented box standing on its base."""

    center_m: tuple[float, float, float]
    """x, y of the centre and z of the base."""
    size_m: tuple[float, float, float]
    """Length (own x), width (own y, depth) and height, all positive."""
    yaw_deg: float
    """Counter-clockwise; at 0 the front faces -y."""

    @property
    def top_m(self) -> float:
        """z of its top."""
        return self.center_m[2] + self.size_m[2]


@dataclass(frozen=True, eq=False)
class Room:
    """A room, bounded by the inner faces of its walls."""

    id: str
    kind: RoomKind
    polygon_m: FloatArray
    """(N, 2) corners, counter-clockwise, first corner not repeated."""
    name: str = ""
    extra: Mapping[str, Any] = field(default_factory=dict)
    """Unknown keys of the JSON element; they survive a round trip."""


@dataclass(frozen=True, eq=False)
class Opening:
    """A door, window or passage (an opening without a leaf) in a wall."""

    id: str
    kind: OpeningKind
    box: Box
    """Length along the wall; width across it; base height and height of the hole."""
    room_ids: tuple[str, ...] = ()
    """The rooms it joins, one or two; empty where not known."""
    extra: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Plan:
    """A vector floor plan. Walls are what lies within WALL_THICKNESS_M of a room and in none."""

    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...]
    extra: Mapping[str, Any] = field(default_factory=dict)

    def room(self, room_id: str) -> Room:
        """The room with this id. Raises KeyError."""
        for room in self.rooms:
            if room.id == room_id:
                return room
        raise KeyError(room_id)

    def scene(self) -> SceneGraph:
        """The house with nothing in it."""
        return SceneGraph(self.rooms, self.openings, (), extra=self.extra)


@dataclass(frozen=True)
class Provenance:
    """What made an artefact; written into every file so that a result can be made again."""

    input_hash: str = ""
    checkpoint_hash: str = ""
    seed: int = 0
    version: str = ""
    configuration: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PlanImage:
    """A plan raster: (H, H, 3) uint8 RGB, CANVAS_PX high or more, and where it lies."""

    rgb: ByteArray
    frame: PixelFrame


@dataclass(frozen=True, eq=False)
class LayoutImage:
    """A layout raster: the plan raster with items painted over it at 0.3 opacity."""

    rgb: ByteArray
    frame: PixelFrame
    provenance: Provenance = field(default_factory=Provenance)


@dataclass(frozen=True, eq=False)
class Detection:
    """One item seen in a layout raster, before it has a room or a mesh."""

    category: str
    corners_px: FloatArray
    """(4, 2) continuous pixels: back left, front left, front right, back right in the own frame."""
    score: float
    """Detector confidence, [0, 1]."""
    mask: BoolArray | None = None
    """(H, W) pixels of the item, where known."""


@dataclass(frozen=True)
class Asset:
    """A mesh of the database."""

    id: str
    category: str
    size_m: tuple[float, float, float]
    usd_path: Path
    """Interface layer of the component."""
    licence: str = ""
    author: str = ""
    styles: tuple[str, ...] = ()
    """Names of the styles (scene.styles) whose form it has; empty where it suits them all."""
    tags: tuple[str, ...] = field(default=(), compare=False)
    """What sets it apart within its category (library.database.TAGS); scenes do not carry it."""


FrontFrom = Literal["mark", "wall", "table", "guess"]


@dataclass(frozen=True)
class Edit:
    """What a rule did to a piece after it was read (arrange.rules)."""

    rule: str
    before: Box


@dataclass(frozen=True)
class Facts:
    """What the steps find out about an item; None or empty where none has."""

    source_px: tuple[tuple[float, float], ...] = ()
    """The corners of what was seen, pixels of the layout raster."""
    front_from: FrontFrom | None = None
    """The sign that decided which way it faces."""
    detected: bool | None = None
    """Whether the detector proposed it, too."""
    below_sill_m: float | None = None
    """Height of the sill of the window that it stands before."""
    asset_distance_m: float | None = None
    """How far the mesh misses its length and width."""
    ood: float | None = None
    """How far from the layout model's expectation it is, from 0; about 1 for one that it would not
    have put there (layout.outlier)."""
    edits: tuple[Edit, ...] = ()
    """What rules did to it, in order."""
    rests_on: str | None = None
    """Id of the piece that dressing lies on, stands in or hangs over: the bed of a throw."""
    unit: str | None = None
    """Of a composed kitchen: the variety of the unit (compose.cut.Variety), "" for a plain one."""
    locked: bool = False
    """Whether it stands where the plan shows it, and stays there."""


@dataclass(frozen=True, eq=False)
class Item:
    """A placed piece. Children (tabletop items) are posed in the frame of their parent."""

    id: str
    category: str
    """Name of a row of palette."""
    box: Box
    """In the world for items of a room, in the parent's own frame for children."""
    room_id: str = ""
    asset: Asset | None = None
    children: tuple[Item, ...] = ()
    score: float = 1.0
    facts: Facts = Facts()
    extra: Mapping[str, Any] = field(default_factory=dict)
    """Unknown keys of the JSON element."""

    def with_facts(self, **facts: Any) -> Item:
        """The item with some of its facts replaced."""
        return replace(self, facts=replace(self.facts, **facts))

    @property
    def moved_m(self) -> float:
        """How far rules moved its middle over the floor."""
        if not self.facts.edits:
            return 0.0
        return round(math.dist(self.facts.edits[0].before.center_m[:2], self.box.center_m[:2]), 6)


@dataclass(frozen=True, eq=False)
class SceneGraph:
    """House > rooms > items > tabletop items; and what the rooms are dressed with."""

    rooms: tuple[Room, ...]
    openings: tuple[Opening, ...]
    items: tuple[Item, ...]
    provenance: Provenance = field(default_factory=Provenance)
    extra: Mapping[str, Any] = field(default_factory=dict)
    dressing: tuple[Item, ...] = ()
    """What hangs on walls and ceilings, lies on floors and furniture, stands on shelves and sills:
    categories of the level DRESSING, boxes in the world, no children."""
    style: str = ""
    """Name of the style (scene.styles) of its furniture, looks and dressing; "" for none."""

    @property
    def plan(self) -> Plan:
        """The same house, unfurnished."""
        return Plan(rooms=self.rooms, openings=self.openings)

    def items_of(self, room_id: str) -> Iterator[Item]:
        """Items that stand in this room, in their order."""
        return (item for item in self.items if item.room_id == room_id)

    def dressing_of(self, room_id: str) -> Iterator[Item]:
        """What this room is dressed with, in its order."""
        return (item for item in self.dressing if item.room_id == room_id)

    def assets(self) -> Iterator[Asset]:
        """The assets of items, of what stands on them, and of dressing."""
        due = [*self.items, *self.dressing]
        for item in due:
            due.extend(item.children)  # a list may grow while it is walked
            if item.asset is not None:
                yield item.asset

    def without(self, item_ids: Iterable[str]) -> SceneGraph:
        """The same house without these items, and what stands on them."""
        gone = set(item_ids)
        return replace(self, items=tuple(item for item in self.items if item.id not in gone))


@dataclass(frozen=True)
class StageFile:
    """A written USD stage."""

    path: Path
    content_hash: str
    provenance: Provenance = field(default_factory=Provenance)
