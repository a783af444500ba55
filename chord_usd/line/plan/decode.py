"""Plan raster -> Plan, to within half a pixel of what was drawn.

What a raster cannot show is filled in: heights of openings (see types.BASE_AND_HEIGHT_M), ids,
and where two rooms of one kind touch without a wall, they are one room.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.vectorize import polygon_from_mask, rotated_box_from_mask
from chord_usd.base.scene import palette
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    BoolArray,
    ByteArray,
    FloatArray,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.plan.openings import Bar, bars_of, read_openings
from chord_usd.line.plan.placement import placement
from chord_usd.line.plan.settle import settle

_SMALLEST_ROOM_M2 = 0.2


def decode_plan(image: PlanImage | ByteArray, m_per_px: float | None = None) -> Plan:
    """The vector plan in a plan raster.

    image: with its frame, or RGB (H, W, 3) alone. m_per_px overrides the frame's; without either
    the walls' thickness gives the scale. Without a frame the lower left corner is the origin.
    Raises PlanError where no closed room is found.
    """
    rgb = image.rgb if isinstance(image, PlanImage) else image
    ink = sort_pixels(rgb)
    frame = _frame(image, ink, m_per_px)
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    bars = [
        *bars_of("door", ink.door, thickness_px),
        *bars_of("window", ink.window, thickness_px),
        *(Bar("passage", mask) for mask in find_passages(ink, thickness_px)),
    ]
    outlines = _room_outlines(ink, bars, frame.m_per_px)
    if not outlines:
        raise PlanError(
            "no closed room was found",
            expected="rooms enclosed by black walls",
            try_="close the gaps between walls, or draw doors in green and windows in blue",
        )
    polygons = settle([outline.polygon_px for outline in outlines], ink.solid, thickness_px)
    rooms = _rooms(outlines, polygons, frame)
    room_ids = [room.id for room in rooms]
    openings = read_openings(bars, polygons, room_ids, thickness_px, frame)
    plan = Plan(rooms, openings, placement(frame))
    return _without_courts(plan) if ink.is_shaded else plan


def _without_courts(plan: Plan) -> Plan:
    """Without white areas of a shaded plan that only windows look onto: those are outside."""
    entered = {i for o in plan.openings if o.kind != "window" for i in o.room_ids}
    looked_onto = {i for o in plan.openings if o.kind == "window" for i in o.room_ids}
    courts = {
        room.id
        for room in plan.rooms
        if room.kind == "unknown" and room.id in looked_onto - entered
    }
    if len(courts) == len(plan.rooms):
        return plan
    openings = tuple(
        replace(opening, room_ids=tuple(i for i in opening.room_ids if i not in courts))
        for opening in plan.openings
    )
    return replace(
        plan,
        rooms=tuple(room for room in plan.rooms if room.id not in courts),
        openings=openings,
    )


def _frame(image: PlanImage | ByteArray, ink: Ink, m_per_px: float | None) -> PixelFrame:
    if isinstance(image, PlanImage):
        if m_per_px is None or m_per_px == image.frame.m_per_px:
            return image.frame
        return PixelFrame(m_per_px, image.frame.origin_m, image.frame.height_px)
    return PixelFrame(m_per_px or measure_scale(ink.solid), (0.0, 0.0), len(image))


@dataclass(frozen=True, eq=False)
class _Outline:
    kind: RoomKind
    polygon_px: FloatArray


def _room_outlines(ink: Ink, bars: list[Bar], m_per_px: float) -> list[_Outline]:
    """The rooms from top to bottom, left to right."""
    closed: BoolArray = np.zeros(ink.wall.shape, bool)
    for bar in bars:
        closed |= bar.mask
    labels = label_floors(ink, closed)
    areas = np.bincount(labels.ravel())
    outlines = []
    for label in np.flatnonzero(areas * m_per_px**2 >= _SMALLEST_ROOM_M2):
        if label > 0:
            mask = labels == label
            shade = int(ink.shade[mask][0])
            outlines.append(_Outline(kind_of_shade(shade), polygon_from_mask(mask)))
    return sorted(outlines, key=lambda outline: tuple(outline.polygon_px.min(axis=0)[::-1]))


def _rooms(
    outlines: list[_Outline], polygons_px: list[FloatArray], frame: PixelFrame
) -> tuple[Room, ...]:
    counts: dict[RoomKind, int] = {}
    rooms = []
    for outline, polygon_px in zip(outlines, polygons_px, strict=True):
        counts[outline.kind] = counts.get(outline.kind, 0) + 1
        name = "room" if outline.kind == "unknown" else outline.kind
        polygon = frozen_array(m_from_px(polygon_px, frame))
        rooms.append(Room(f"{name}{counts[outline.kind]}", outline.kind, polygon))
    return tuple(rooms)


# Gaps in walls that carry no leaf: where a plan raster lets one room run into the next -----------

# In a shaded raster a passage is a white bar of the wall's thickness between grey rooms. In an
# unshaded one it shows only by the ends of the walls on both sides of it.

_T = TypeVar("_T", bound=np.generic)

_WIDEST_WALLS = 11.0
"""A gap of more wall thicknesses than this (2.64 m) is no passage but a room's own shape."""

_THICKNESS_SLACK_PX = 1.2


@dataclass(frozen=True)
class Gap:
    """A passage in a wall that runs along the rows of an image, or of the transposed image."""

    top: int
    bottom: int
    left: int
    right: int
    transposed: bool

    def inner(self, image: npt.NDArray[_T]) -> npt.NDArray[_T]:
        """View of the gap's pixels."""
        return self._turned(image)[self.top : self.bottom, self.left : self.right]

    def sides(self, image: npt.NDArray[_T]) -> tuple[_T, _T]:
        """The most frequent values along both faces of the wall."""
        rows = self._turned(image)[:, self.left : self.right]
        return _mode(rows[self.top - 1]), _mode(rows[self.bottom])

    def _turned(self, image: npt.NDArray[_T]) -> npt.NDArray[_T]:
        return image.T if self.transposed else image


def _mode(values: npt.NDArray[_T]) -> _T:
    distinct, counts = np.unique(values, return_counts=True)
    return distinct[np.argmax(counts)]


def find_passages(ink: Ink, thickness_px: float) -> list[BoolArray]:
    """One (H, W) mask for each passage of a plan raster with walls this thick."""
    passages = _white_bars(ink, thickness_px) if ink.is_shaded else []
    closed = np.zeros(ink.wall.shape, bool)
    for mask in passages:
        closed |= mask
    for gap in _parting_gaps(ink, closed, thickness_px):
        mask = np.zeros(ink.wall.shape, bool)
        gap.inner(mask)[:] = True
        passages.append(mask)
    return passages


def _white_bars(ink: Ink, thickness_px: float) -> list[BoolArray]:
    """White regions inside the house that are as thin as a wall."""
    count, labels = cv2.connectedComponents(ink.white.astype(np.uint8), connectivity=4)
    bars = []
    for label in sorted(set(range(1, count)) - set(border_values(labels).tolist())):
        mask = labels == label
        box = rotated_box_from_mask(mask)
        thin = abs(box.width_px - thickness_px) <= _THICKNESS_SLACK_PX
        if (
            thin
            and box.length_px > thickness_px
            and mask.sum() > 0.8 * box.length_px * box.width_px
        ):
            bars.append(mask)
    return bars


def _parting_gaps(ink: Ink, closed: BoolArray, thickness_px: float) -> list[Gap]:
    """Gaps between wall ends that part two rooms once they are all closed."""
    solid = ink.solid | closed
    gaps = _gaps_along_rows(solid, thickness_px, transposed=False)
    gaps += _gaps_along_rows(solid.T, thickness_px, transposed=True)
    gaps = [gap for gap in gaps if _is_paved_as_gap(ink, gap)]
    shut = closed.copy()
    for gap in gaps:
        gap.inner(shut)[:] = True
    labels = label_floors(ink, shut)
    return [gap for gap in gaps if len(set(gap.sides(labels))) == 2]


def _is_paved_as_gap(ink: Ink, gap: Gap) -> bool:
    """White, or with the floor of just one of its sides; else the floor merely runs past a wall."""
    shades = np.unique(gap.inner(ink.shade))
    first, second = gap.sides(ink.shade)
    return len(shades) == 1 and (first != second or bool(gap.inner(ink.white).all()))


def _gaps_along_rows(solid: BoolArray, thickness_px: float, *, transposed: bool) -> list[Gap]:
    """Open stretches between the end of a wall that runs along the rows and what it faces."""
    gaps = _gaps_to_the_right(solid, thickness_px, transposed)
    width = solid.shape[1]
    for gap in _gaps_to_the_right(solid[:, ::-1], thickness_px, transposed):
        mirrored = replace(gap, left=width - gap.right, right=width - gap.left)
        if mirrored not in gaps:
            gaps.append(mirrored)
    return gaps


def _gaps_to_the_right(solid: BoolArray, thickness_px: float, transposed: bool) -> list[Gap]:
    """As _gaps_along_rows, from wall ends that face right."""
    height = len(solid)
    starts = solid.copy()
    starts[1:] &= ~solid[:-1]
    starts[:, :-1] &= ~solid[:, 1:]
    starts[:, -1] = False
    longest = int(_WIDEST_WALLS * thickness_px)
    gaps = []
    for top, column in np.argwhere(starts).tolist():
        open_below = np.flatnonzero(~solid[top:, column])
        bottom = top + int(open_below[0]) if len(open_below) else height
        if abs(bottom - top - thickness_px) > _THICKNESS_SLACK_PX or not 0 < top < bottom < height:
            continue
        beyond = solid[top:bottom, column + 1 : column + 2 + longest]
        reached = np.flatnonzero(beyond.any(axis=0))
        if len(reached) == 0 or reached[0] < thickness_px or not beyond[:, reached[0]].all():
            continue
        gap = Gap(top, bottom, column + 1, column + 1 + int(reached[0]), transposed)
        along = slice(gap.left, gap.right)
        if not (solid[top - 1, along].any() or solid[bottom, along].any()):
            gaps.append(gap)
    return gaps


# How many pixels thick the walls of a plan raster are, which gives the raster its scale ----------

_SHORTEST_WALL_PX = 4
_HEAVIEST_WALL_PX = 20
"""A longer wall says no more about the thickness than one of this length."""


def wall_thickness_px(solid: BoolArray) -> float:
    """Thickness of the walls to a fraction of a pixel, (H, W) pixels of walls and openings given.

    Each wall along an axis is drawn a whole number of pixels thick, rounded up or down as it
    happens to lie; their mean is the thickness. Raises PlanError where there is no such wall.
    """
    lengths, weights = (
        np.concatenate(parts) for parts in zip(_crossings(solid), _crossings(solid.T), strict=True)
    )
    if len(lengths) == 0:
        raise PlanError(
            "no wall along an axis was found", expected="walls drawn black", try_="<m_per_px>"
        )
    # The thickness that most wall has; thicker runs are junctions and walls seen lengthwise.
    usual = int(np.argmax(np.convolve(np.bincount(lengths, weights), [1.0, 1.0])[1:]))
    near = (lengths >= usual) & (lengths <= usual + 1)
    return float(np.average(lengths[near], weights=weights[near]))


def measure_scale(solid: BoolArray) -> float:
    """Metres per pixel, from walls WALL_THICKNESS_M thick. Raises PlanError."""
    return WALL_THICKNESS_M / wall_thickness_px(solid)


def _crossings(solid: BoolArray) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[type-arg]
    """Thickness and weight of every wall that runs along the rows."""
    padded = np.pad(solid, ((1, 1), (0, 0))).astype(np.int8)
    change = np.diff(padded, axis=0).T
    columns, tops = np.nonzero(change == 1)
    bottoms = np.nonzero(change == -1)[1]
    # Runs of neighbouring columns with the same ends are one wall.
    order = np.lexsort((columns, bottoms, tops))
    columns, tops, bottoms = columns[order], tops[order], bottoms[order]
    starts = np.ones(len(columns), bool)
    starts[1:] = (np.diff(tops) != 0) | (np.diff(bottoms) != 0) | (np.diff(columns) != 1)
    walls = np.flatnonzero(starts)
    extents = np.diff(np.append(walls, len(columns)))
    thickness = bottoms[walls] - tops[walls]
    is_wall = (extents >= _SHORTEST_WALL_PX) & (extents > 1.5 * thickness)
    weights = np.minimum(extents[is_wall], _HEAVIEST_WALL_PX).astype(np.float64)
    return thickness[is_wall], weights


# What each pixel of a plan raster shows: wall, door, window, or the floor of some room -----------

_DARKEST_FLOOR = 128
"""Floors are light; the darkest room shade is 172."""

_LEAST_COLOR = 40
"""Difference between channels from which a pixel is door or window, not a shade of grey."""

_SHADE_STEP = 4
"""A floor within so many grey levels of a room kind's shade is of that kind."""

_KINDS = tuple(palette.ROOM_SHADES)
_SHADES = np.array([palette.ROOM_SHADES[kind][0] for kind in _KINDS])
_WHITE = _KINDS.index("unknown")


@dataclass(frozen=True, eq=False)
class Ink:
    """A plan raster, sorted. All arrays (H, W)."""

    wall: BoolArray
    door: BoolArray
    window: BoolArray
    shade: ByteArray
    """Floors: index of the room kind, or some number beyond for shades of no kind."""

    @property
    def solid(self) -> BoolArray:
        """Everything that stands between rooms: walls, doors and windows."""
        return self.wall | self.door | self.window

    @property
    def white(self) -> BoolArray:
        """Outside, passages, and floors of unknown kind."""
        return (self.shade == _WHITE) & ~self.solid

    @property
    def is_shaded(self) -> bool:
        """Whether rooms differ in shade."""
        return bool(np.any((self.shade != _WHITE) & ~self.solid))


def sort_pixels(rgb: ByteArray) -> Ink:
    """Sort the pixels of a plan raster (H, W, 3) by the palette's plan colours."""
    darkest, lightest = rgb.min(axis=2), rgb.max(axis=2)
    colored = lightest.astype(np.int16) - darkest > _LEAST_COLOR
    nearest = np.argmin(
        [
            np.abs(rgb.astype(np.int16) - np.array(palette.category(name).rgb)).sum(axis=2)
            for name in ("door", "window")
        ],
        axis=0,
    )
    wall = ~colored & (lightest < _DARKEST_FLOOR)
    return Ink(wall, colored & (nearest == 0), colored & (nearest == 1), _shade_codes()[lightest])


def _shade_codes() -> ByteArray:
    """(256,) code of each grey level."""
    distances = np.abs(np.arange(256)[:, None] - _SHADES)
    codes = np.argmin(distances, axis=1)
    foreign = distances.min(axis=1) > _SHADE_STEP
    codes[foreign] = len(_KINDS) + np.flatnonzero(foreign) // 8
    return codes.astype(np.uint8)


def kind_of_shade(code: int) -> RoomKind:
    """The room kind of a shade code; unknown for a shade of no kind."""
    return _KINDS[code] if code < len(_KINDS) else "unknown"


def label_floors(ink: Ink, closed: BoolArray) -> npt.NDArray[np.int32]:
    """(H, W) a number for each room, 0 for what is none: connected floor of one shade.

    closed: pixels that part rooms besides the solid ones (passages). White floor that reaches the
    border of the raster is outside.
    """
    floor = ~(ink.solid | closed)
    labels = np.zeros(floor.shape, np.int32)
    count = 0
    for code in np.unique(ink.shade[floor]):
        part = (floor & (ink.shade == code)).astype(np.uint8)
        parts, numbers = cv2.connectedComponents(part, connectivity=4)
        inner = np.arange(parts)
        if code == _WHITE:
            inner[border_values(numbers)] = 0
        labels += np.where(inner > 0, inner + count, 0)[numbers].astype(np.int32)
        count += parts
    return labels


def border_values(image: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The distinct values along the four sides of an image."""
    return np.unique(np.concatenate([image[0], image[-1], image[:, 0], image[:, -1]]))
