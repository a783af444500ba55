"""Furniture and fixtures that a drawing shows, found by a network."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import Point, Polygon

from chord_usd.base.errors import CheckpointError
from chord_usd.base.raster.page_labels import (
    PIECE_M_PER_PX,
    PIECE_MULTIPLE_PX,
    PIECE_NAMES,
    PIECE_STEP_PX,
    READER_INPUT,
)
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import Network, load_network
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, ByteArray, FloatArray, Item, PixelFrame, Room, RoomKind
from chord_usd.base.scene.units import m_from_px, wrap_deg
from chord_usd.line.plan.seen import SeenReading
from chord_usd.line.plan.sheet import Sheet, on_white

PIECES_CHECKPOINT = "symbols"
_REMEDY = ("<train=symbols>", "<reinstall>")

FOLLOWING = frozenset(["chair"])
"""What stands where other pieces are: it helps the network to distinguish these."""
LEAST_CHANCE = 0.3
_FAINT = 0.4
"""Share of the chance from which on a piece counts, for what its room lacks."""
_NEEDED: dict[RoomKind, tuple[frozenset[str], ...]] = {
    "bathroom": tuple(
        frozenset(fixtures) for fixtures in (("toilet",), ("washbasin",), ("shower", "bathtub"))
    ),
    "wc": (frozenset(("toilet",)), frozenset(("washbasin",))),
    "kitchen": (frozenset(("sink_cabinet",)), frozenset(("cooker_cabinet",))),
    "bedroom": (frozenset(("bed",)),),
}
"""What rooms of a kind usually show, each of these once or more."""
_ENLARGED = 2.2
"""A picture is not enlarged more than this, as in training."""
_TILE_PX, _OVERLAP_PX = 768, 96
_SAME_SPOT = 0.5
"""Of two pieces whose centres are nearer than this share of the smaller one's shorter side, the
likelier is there."""
_SWING_NEAR, _SWING_ALIKE = 0.3, 0.35
"""A shower whose rim is so near to the middle of a door, and whose side is so nearly as long as the
door is wide, is its swing: shares of that width."""

Map = npt.NDArray[np.float32]


@dataclass(frozen=True)
class SeenPiece:
    """A piece as it is drawn, in pixels of the picture, y down."""

    category: str
    chance: float
    center_px: tuple[float, float]
    length_px: float
    depth_px: float
    front: tuple[float, float]
    """Unit vector."""
    is_sure: bool = True
    """Whether it counts wherever it is; else only where its room lacks one."""


class PieceFinder:
    """The network of a checkpoint."""

    def __init__(self, network: Network, least: Mapping[str, float]) -> None:
        """least: by category, the chance from which on a piece counts."""
        self._network = network
        self._least = np.array([least.get(name, LEAST_CHANCE) for name in PIECE_NAMES])

    def find(self, rgb: ByteArray, m_per_px: float, least: float | None = None) -> list[SeenPiece]:
        """Pieces on a picture, (H, W, 3), the surest and likeliest first.

        m_per_px: its scale. least: chance from which on a piece counts, in place of the
        checkpoint's; without it, faint ones are there, too.
        """
        enough = self._least if least is None else np.full(len(PIECE_NAMES), least)
        share = min(m_per_px / PIECE_M_PER_PX, _ENLARGED)
        size = tuple(max(PIECE_MULTIPLE_PX, round(side * share)) for side in rgb.shape[1::-1])
        way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_CUBIC
        small = np.asarray(cv2.resize(rgb, size, interpolation=way), np.uint8)
        # Where the picture is finer than it may be enlarged to, sizes are at its own scale.
        pieces = [piece for window in _windows((small.shape[0], small.shape[1]))
                 for piece in self._in_window(small, window, enough)]  # fmt: skip
        pieces.sort(key=lambda piece: (not piece.is_sure, -piece.chance))
        return [_times(piece, 1.0 / share) for piece in _apart(pieces)]

    def _in_window(
        self, rgb: ByteArray, window: tuple[slice, slice], least: FloatArray
    ) -> Iterator[SeenPiece]:
        part = rgb[window]
        height, width = part.shape[:2]
        more = (-height % PIECE_MULTIPLE_PX, -width % PIECE_MULTIPLE_PX)
        padded = cv2.copyMakeBorder(part, 0, more[0], 0, more[1], cv2.BORDER_REPLICATE)
        scaled = padded.transpose(2, 0, 1)[None].astype(np.float32) / 127.5 - 1.0
        centres, shapes = (batch[0] for batch in self._network.run({READER_INPUT: scaled}))
        # What is there is there in the mirror, too; what was taken for it by chance may not be.
        mirror = np.ascontiguousarray(scaled[..., ::-1])
        centres = (centres + self._network.run({READER_INPUT: mirror})[0][0, ..., ::-1]) / 2
        corner = np.array([window[1].start, window[0].start], np.float64)
        faint = _FAINT * self._least if least is self._least else least
        for kind, row, column in zip(*_peaks(centres, faint), strict=True):
            x, y, length, depth, front_x, front_y = shapes[:, row, column].astype(float)
            at = np.array([column + x, row + y]) * PIECE_STEP_PX + corner
            norm = max(float(np.hypot(front_x, front_y)), 1e-6)
            yield SeenPiece(
                PIECE_NAMES[kind], float(centres[kind, row, column]), (at[0], at[1]),
                float(np.exp(length)), float(np.exp(depth)), (front_x / norm, front_y / norm),
                bool(centres[kind, row, column] >= least[kind]),
            )  # fmt: skip


@cache
def load_finder(folder: Path) -> PieceFinder:
    """The finder of a checkpoint folder. Raises CheckpointError."""
    network = load_network(folder, _REMEDY)
    try:
        config = json.loads((folder / "config.json").read_text(encoding="utf-8"))
        least = {str(name): float(chance) for name, chance in config.get("least", {}).items()}
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise CheckpointError(
            f"the description cannot be read ({str(error).splitlines()[0]})",
            where=str(folder / "config.json"),
            try_=_REMEDY,
        ) from error
    return PieceFinder(network, least)


def _peaks(centres: Map, least: FloatArray) -> tuple[np.ndarray, ...]:
    """Kind, row and column of cells that are likelier than all beside them."""
    top = np.stack([cv2.dilate(centre_map, np.ones((3, 3), np.uint8)) for centre_map in centres])
    return np.nonzero((centres >= top) & (centres >= least[:, None, None]))


def _windows(shape: tuple[int, int]) -> Iterator[tuple[slice, slice]]:
    rows, columns = (list(_pieces_of(side)) for side in shape)
    yield from ((row, column) for row in rows for column in columns)


def _pieces_of(side: int) -> Iterator[slice]:
    start = 0
    while True:
        yield slice(start, min(start + _TILE_PX, side))
        if start + _TILE_PX >= side:
            return
        start += _TILE_PX - _OVERLAP_PX


def _apart(pieces: list[SeenPiece]) -> list[SeenPiece]:
    """Without those that stand where a likelier one stands."""
    kept: list[SeenPiece] = []
    for piece in pieces:
        short = min(piece.length_px, piece.depth_px)
        for other in kept:
            near = _SAME_SPOT * min(short, other.length_px, other.depth_px)
            if np.hypot(*np.subtract(piece.center_px, other.center_px)) < near:
                break
        else:
            kept.append(piece)
    return kept


def _times(piece: SeenPiece, by: float) -> SeenPiece:
    x, y = piece.center_px
    return replace(
        piece, center_px=(x * by, y * by), length_px=piece.length_px * by,
        depth_px=piece.depth_px * by,
    )  # fmt: skip


def as_items(pieces: Iterable[SeenPiece], frame: PixelFrame) -> list[Item]:
    """Pieces in metres. frame: of the picture that they were seen on."""
    items = []
    for piece in pieces:
        x, y = m_from_px(np.array([piece.center_px]), frame)[0].tolist()
        row = category(piece.category)
        front_x, front_y = piece.front
        # The front looks to -y at yaw 0; pixels count downwards.
        yaw_deg = wrap_deg(float(np.degrees(np.arctan2(front_x, front_y))))
        length, depth = (side * frame.m_per_px for side in (piece.length_px, piece.depth_px))
        box = Box((x, y, row.mount_height_m), (length, depth, sum(row.height_m) / 2), yaw_deg)
        items.append(Item("", piece.category, box, score=piece.chance))
    return items


def found_on(sheet: Sheet, m_per_px: float) -> list[SeenPiece]:
    """What the checkpoint's finder sees on a sheet's fine picture. m_per_px: of the working one."""
    finder = load_finder(checkpoint_folder(PIECES_CHECKPOINT))
    return finder.find(on_white(sheet.fine), m_per_px / sheet.fine_per_px)


def pieces_within(
    seen_pieces: Iterable[SeenPiece],
    reading: SeenReading,
    sheet: Sheet,
    frame: PixelFrame,
    *,
    is_sure: bool = True,
) -> list[Item]:
    """Of what was found on a sheet's fine picture, the sure or the faint pieces on a reading's
    floors, in metres.

    No chairs, and no shower where a door swings. frame: of the working picture."""
    height_px = sheet.fine.shape[0]
    fine = replace(frame, m_per_px=frame.m_per_px / sheet.fine_per_px, height_px=height_px)
    rooms = [Polygon(m_from_px(corners, frame)) for corners in reading.polygons_px]
    doors = [
        (Point(m_from_px(opening.center_px, frame)), opening.length_px * frame.m_per_px)
        for opening in reading.openings if opening.kind == "door"
    ]  # fmt: skip
    house = shapely.union_all([room.buffer(0) for room in rooms])
    return [
        item for item in as_items([seen for seen in seen_pieces if seen.is_sure == is_sure], fine)
        if item.category not in FOLLOWING and house.covers(Point(item.box.center_m[:2]))
        and not any(_is_swing(item, *door) for door in doors)
    ]  # fmt: skip


def with_needed(sure: Sequence[Item], faint: Sequence[Item], rooms: Iterable[Room]) -> list[Item]:
    """The sure pieces, and the likeliest faint one of each sort that a room of its kind shows, and
    that this one would lack."""
    pieces = list(sure)
    for room in rooms:
        floor = room_polygon(room)
        there = {item.category for item in sure if floor.covers(Point(item.box.center_m[:2]))}
        in_room = [item for item in faint if floor.covers(Point(item.box.center_m[:2]))]
        for sort in _NEEDED.get(room.kind, ()):
            likely = [item for item in in_room if item.category in sort]
            if likely and there.isdisjoint(sort):
                pieces.append(max(likely, key=lambda item: item.score))
    return pieces


def _is_swing(piece: Item, door: Point, width_m: float) -> bool:
    """Whether a shower is rather the quarter of a circle that a door leaf swings through."""
    near = _SWING_NEAR * width_m
    return (
        piece.category == "shower"
        and min(abs(side - width_m) for side in piece.box.size_m[:2]) < _SWING_ALIKE * width_m
        and footprint_polygon(piece.box).exterior.distance(door) < near
    )
