"""A room that is being dressed: its walls, what takes its space, what it is dressed with so far."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import shapely
from shapely.geometry import LineString

from chord_usd.base.errors import AssetError
from chord_usd.base.places.free_places import Walkways
from chord_usd.base.places.room_space import take_swings
from chord_usd.base.places.swept import swept_box
from chord_usd.base.places.taken_space import Reason, TakenSpace
from chord_usd.base.places.wall_frames import Hole, WallFace
from chord_usd.base.raster.relief import Relief
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    room_polygon,
)
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Asset, Box, FloatArray, Item, Room, RoomKind
from chord_usd.library.asset_shapes import boards_of, leaves_of, relief_of
from chord_usd.line.dressing.stock import Draws, Stock, Taste

IN_ROOM_M = 0.002
"""What reaches farther beyond the floor of its room is not in it."""

_PASSED = ("rug", "clear", "pane", "open", "front", "swing")
"""Reasons of space that doors of furniture may pass."""

_AT_WALL_M = 0.03
"""What hangs on a wall has its back no farther from it."""


@dataclass(eq=False)
class RoomFrame:
    """One room in work."""

    room: Room
    faces: tuple[WallFace, ...]
    pieces: tuple[Item, ...]
    """Its furniture, with what stands on it."""
    taken: TakenSpace
    walkways: Walkways
    stock: Stock
    taste: Taste
    draws: Draws
    """Of the room."""
    house: Draws
    """Of what agrees through the house."""
    reliefs: ReliefsOf
    balcony_doors: frozenset[str] = frozenset()
    """Ids of openings that lead to balconies."""
    entrance: tuple[WallFace, Hole] | None = None
    """The front door of the house, where it is one of this room's."""
    place_in_house: tuple[int, int] = (0, 1)
    """Which of how many rooms it is."""
    placed: list[Item] = field(default_factory=list)
    """Without ids yet, but for what stays."""

    @cached_property
    def floor(self) -> shapely.Polygon:
        """Inner faces of its walls."""
        return room_polygon(self.room)

    @cached_property
    def _grown(self) -> shapely.Polygon:
        grown = self.floor.buffer(IN_ROOM_M, join_style="mitre")
        shapely.prepare(grown)
        return grown

    @property
    def kind(self) -> RoomKind:
        """Of the room."""
        return self.room.kind

    def of(self, *categories: str) -> list[Item]:
        """Its furniture of these categories."""
        return [item for item in self.pieces if item.category in categories]

    def dressed(self, *categories: str) -> list[Item]:
        """Its dressing of these categories so far."""
        return [item for item in self.placed if item.category in categories]

    def holes(self, *kinds: str) -> Iterator[tuple[WallFace, Hole]]:
        """Openings of these kinds, with the wall that they are in."""
        for face in self.faces:
            for hole in face.holes:
                if hole.opening.kind in kinds:
                    yield face, hole

    def is_own(self, asset: Asset) -> bool:
        """Whether an asset is this room's rather than another's: no two show the same picture."""
        index, count = self.place_in_house
        return int(self.house.share(f"own/{asset.id}") * count) == index

    def is_inside(self, box: Box) -> bool:
        """Whether a box stands within the room's walls, below its ceiling and above its floor."""
        top_m = box.top_m
        if box.center_m[2] < -1e-6 or top_m > ROOM_HEIGHT_M + 1e-6:
            return False
        return bool(self._grown.covers(footprint_polygon(box)))

    def fits(
        self, box: Box, ignoring: Collection[str] = ("rug",), but: Collection[str] = ()
    ) -> bool:
        """Whether a box is in the room and free."""
        return self.is_inside(box) and not self.taken.hits(box, ignoring, but)

    def against(
        self, face: WallFace, middle_m: float, base_m: float, size_m: tuple[float, float, float]
    ) -> Box | None:
        """A box with its back on a wall, or on the splashback that is there; None over its edge."""
        bare = face.box(middle_m, base_m, size_m)
        low, high, _, _ = face.span_of(bare)
        for panel in self.dressed("splashback"):
            left, right, near_m, face_m = face.span_of(panel.box)
            covers = left <= low and high <= right and panel.box.center_m[2] <= base_m
            if near_m < 0.0 or near_m > _AT_WALL_M or min(right, high) <= max(left, low):
                continue
            if panel.box.top_m <= base_m or panel.box.center_m[2] >= bare.top_m:
                continue
            is_whole = covers and bare.top_m <= panel.box.top_m
            return face.box(middle_m, base_m, size_m, face_m) if is_whole else None
        return bare

    def has_wall_behind(self, box: Box, within_m: float = _AT_WALL_M) -> bool:
        """Whether the whole back of a box is at a wall: walls end where a room has a corner."""
        back = LineString(footprint(box)[[0, 3]])
        return bool(self.floor.exterior.buffer(within_m, join_style="mitre").covers(back))

    def put(
        self,
        asset: Asset,
        box: Box,
        *,
        rests_on: str | None = None,
        reason: Reason = "dressing",
    ) -> Item:
        """Place an asset, wherever that is: whoever calls has seen that it fits."""
        item = Item(f"{len(self.placed)}", asset.category, rounded(box), self.room.id,
                    self.stock.fetch(asset))  # fmt: skip
        if rests_on is not None:
            item = item.with_facts(rests_on=rests_on)
        self.placed.append(item)
        self.taken.add(item.box, reason, item.id)
        take_swings(self.taken, (item,), leaves_of)
        return item

    def put_where_free(
        self,
        asset: Asset,
        box: Box,
        *,
        rests_on: str | None = None,
        ignoring: Collection[str] = ("rug",),
        but: Collection[str] = (),
    ) -> Item | None:
        """Place an asset if its box is in the room and free."""
        row = CATEGORIES.get(asset.category)
        hangs = row is not None and row.mount is Mount.WALL and rests_on is None
        if not self.fits(box, ignoring, but) or (hangs and not self.has_wall_behind(box)):
            return None
        if not self._can_open(asset, box):
            return None
        return self.put(asset, box, rests_on=rests_on)

    def _can_open(self, asset: Asset, box: Box) -> bool:
        """Whether nothing is where the doors of a piece swing."""
        item = Item("", asset.category, box, self.room.id, self.stock.fetch(asset))
        swings = (swept_box(leaf, box) for leaf in leaves_of(item))
        return not any(self.taken.hits(swing, _PASSED) for swing in swings)

    def hang_group(self, group: Sequence[tuple[Asset, Box]]) -> bool:
        """Hang all of a group where each is free and has a wall behind it, or none of it."""
        if not all(self.fits(box) and self.has_wall_behind(box) for _, box in group):
            return False
        for asset, box in group:
            self.put(asset, box)
        return True

    def boards(self, item: Item) -> FloatArray:
        """Open boards of a piece; none of one without a mesh."""
        return self.reliefs.boards(item)

    def relief(self, item: Item) -> Relief:
        """How high a piece is, seen from above; a box for one without a mesh."""
        return self.reliefs(item)


class ReliefsOf:
    """What is measured on the meshes of placed pieces; those without a mesh are boxes."""

    def __call__(self, item: Item) -> Relief:
        """How high it is, at the size of the piece."""
        if item.asset is not None and item.asset.usd_path.is_file():
            with contextlib.suppress(AssetError):
                return relief_of(item.asset).scaled(item.box.size_m)
        return Relief(np.full((8, 8), item.box.size_m[2]), item.box.size_m)

    def boards(self, item: Item) -> FloatArray:
        """(N, 6) open boards in the frame and at the size of the asset."""
        if item.asset is not None and item.asset.usd_path.is_file():
            with contextlib.suppress(AssetError):
                return boards_of(item.asset)
        length, depth, height = item.box.size_m
        top = [-length / 2, -depth / 2, height, length / 2, depth / 2, height + 0.4]
        return np.array([top] if item.category == "wall_shelf" else []).reshape(-1, 6)


def rounded(box: Box) -> Box:
    """To a hundredth of a millimetre, so that files hold it whole."""
    return Box(
        tuple(round(float(value), 5) for value in box.center_m),  # type: ignore[arg-type]
        tuple(round(float(value), 5) for value in box.size_m),  # type: ignore[arg-type]
        round(float(box.yaw_deg), 4),
    )


def named(items: Iterable[Item], room_id: str, taken_ids: Collection[str]) -> Iterator[Item]:
    """The items with ids room/dressing/category_n, and what they rest on by its new id.

    taken_ids: of what stays as it is.
    """
    counts: Counter[str] = Counter()
    ids: dict[str, str] = {}
    for item in items:
        if item.id in taken_ids:
            yield item
            continue
        while True:
            new_id = f"{room_id}/dressing/{item.category}_{counts[item.category]}"
            counts[item.category] += 1
            if new_id not in taken_ids:
                break
        ids[item.id] = new_id
        rests_on = item.facts.rests_on
        if rests_on is not None and rests_on in ids:
            item = item.with_facts(rests_on=ids[rests_on])
        yield replace(item, id=new_id)
