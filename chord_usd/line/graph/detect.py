"""YOLOv8 on layout rasters: oriented boxes of items, masks of rooms.

What the networks say is a proposal: snap.py takes the pixels' word over it. yolo.py
builds and trains them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.checksums import check_file
from chord_usd.base.runtime.extras import REINSTALL
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import GRAPH_FILE, WEIGHTS_FILE, Network, load_network
from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import (
    CANVAS_PX,
    LEARNED_KINDS,
    BoolArray,
    Box,
    ByteArray,
    Detection,
    FloatArray,
    PixelFrame,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import px_from_m

Kind = Literal["items", "rooms"]

ROOM_CLASSES: tuple[RoomKind, ...] = tuple(kind for kind in LEARNED_KINDS if kind != "unknown")
CLASSES: dict[Kind, tuple[str, ...]] = {
    "items": tuple(row.name for row in HOUSE_CATEGORIES),
    "rooms": ROOM_CLASSES,
}

IMAGE_PX: dict[Kind, int] = {"items": CANVAS_PX, "rooms": 192}
"""What the networks look at. Rooms are large: three quarters of the canvas cost half as much."""

LEAST_SIDE_PX = 8.0
"""Items are taught and proposed with boxes at least this long and wide.

A box must hold a point of the output grid to be proposed, and the finest grid has one every 8
pixels: most panels drawn at their true thickness, a pixel or two, would be missed.
"""

CONFIG_FILE = "config.json"
FORMAT = 1

MIN_SCORE = 0.25
"""Proposals below this confidence are dropped (ultralytics' own default)."""
LEAST_SCORE = 0.01
"""What the networks themselves drop; precision is integrated down to it."""

MOST_PROPOSALS = 150
"""Suppressing doubles takes the square of five times as many."""


@dataclass(frozen=True, eq=False)
class RoomProposal:
    """One room the segmentation network sees."""

    kind: RoomKind
    score: float
    """[0, 1]."""
    mask: BoolArray
    """(CANVAS_PX, CANVAS_PX)."""


class ItemDetector:
    """Finds items as oriented boxes. Load with load_item_detector."""

    def __init__(self, network: Network) -> None:
        self._network = network

    def detect(self, rgb: ByteArray, min_score: float = MIN_SCORE) -> list[Detection]:
        """Proposals for a layout raster, (CANVAS_PX, CANVAS_PX, 3) uint8, best first.

        corners_px outline the box; which side is the front is not known here.
        """
        return [
            Detection(
                category=HOUSE_CATEGORIES[int(row[5])].name,
                corners_px=frozen_array(_box_corners(row)),
                score=float(row[4]),
            )
            for row in self.rows(rgb, min_score)
        ]

    def rows(self, rgb: ByteArray, min_score: float) -> FloatArray:
        """(N, 7) x, y, length, width, score, class and radians of the proposals for a raster.

        min_score: LEAST_SCORE at least.
        """
        rows = self._network.run({"rgb": rgb[None]})[0][0].astype(np.float64)
        return rows[rows[:, 4] >= min_score]


class RoomSegmenter:
    """Finds rooms and their kinds. Load with load_room_segmenter."""

    def __init__(self, network: Network) -> None:
        self._network = network

    def segment(self, rgb: ByteArray, min_score: float = MIN_SCORE) -> list[RoomProposal]:
        """Rooms of a layout or plan raster, (CANVAS_PX, CANVAS_PX, 3) uint8, best first.

        min_score: LEAST_SCORE at least.
        """
        side = IMAGE_PX["rooms"]
        raw, protos = self._network.run({"rgb": scaled(rgb, side)[None]})
        rows = raw[0][raw[0][:, 4] >= min_score]
        boxes = rows[:, :4] * (CANVAS_PX / side)
        planes = np.einsum("nc,chw->nhw", rows[:, 6:], protos[0])
        return [
            RoomProposal(ROOM_CLASSES[int(row[5])], float(row[4]), _within(_enlarged(plane), box))
            for row, plane, box in zip(rows, planes, boxes, strict=True)
        ]


def taught_box(box: Box, frame: PixelFrame) -> FloatArray:
    """(5,) x, y, length, width, radians of an item on the canvas, as the network is taught it.

    Sides are LEAST_SIDE_PX at least; the angle is clockwise as seen, in [-pi/4, pi/4).
    """
    x, y = px_from_m(np.array(box.center_m[:2]), frame)
    length, width = (max(side / frame.m_per_px, LEAST_SIDE_PX) for side in box.size_m[:2])
    quarters, rest = divmod(-box.yaw_deg + 45.0, 90.0)
    if int(quarters) % 2:
        length, width = width, length
    return np.array([x, y, length, width, np.radians(rest - 45.0)])


def load_item_detector(folder: Path | None = None) -> ItemDetector:
    """The detector in folder, by default the shipped one. Raises CheckpointError."""
    return ItemDetector(_load("items", folder))


def load_room_segmenter(folder: Path | None = None) -> RoomSegmenter:
    """The segmenter in folder, by default the shipped one. Raises CheckpointError."""
    return RoomSegmenter(_load("rooms", folder))


def remedy(kind: Kind) -> tuple[str, str]:
    """How to come by a checkpoint that can be used."""
    return REINSTALL, f"<detector={kind}>"


def check_config(kind: Kind, folder: Path) -> None:
    """Raises CheckpointError where folder's networks are not for this version and kind."""
    path = folder / CONFIG_FILE
    try:
        config = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise CheckpointError(
            f"the configuration cannot be read ({error})", where=str(path), try_=remedy(kind)
        ) from error
    wanted = {"format": FORMAT, "kind": kind, "classes": list(CLASSES[kind])}
    for key, value in wanted.items():
        if not isinstance(config, dict) or config.get(key) != value:
            raise CheckpointError(
                f"'{key}' does not fit this version of chord-usd",
                where=str(path),
                expected=str(value),
                try_=remedy(kind),
            )
    check_file(path)


def _load(kind: Kind, folder: Path | None) -> Network:
    name = f"detector_{kind}"
    try:
        folder = folder or checkpoint_folder(name)
        if not folder.is_dir():
            raise CheckpointError(f"there is no checkpoint {name!r}", where=str(folder))
    except CheckpointError as error:
        raise CheckpointError(
            error.what,
            where=error.where,
            expected=f"a folder with {GRAPH_FILE}, {WEIGHTS_FILE} and {CONFIG_FILE}",
            try_=remedy(kind),
        ) from None
    check_config(kind, folder)
    return load_network(folder, remedy(kind))


def scaled(rgb: ByteArray, side_px: int) -> ByteArray:
    """A square raster (H, H, 3) at another size; areas keep their mean colour."""
    if rgb.shape[0] == side_px:
        return rgb
    small = cv2.resize(rgb, (side_px, side_px), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def _enlarged(plane: npt.NDArray[np.float32]) -> BoolArray:
    """A mask's logits (h, w) on the canvas."""
    whole = cv2.resize(plane, (CANVAS_PX, CANVAS_PX), interpolation=cv2.INTER_LINEAR)
    return np.asarray(whole) > 0.0


def _within(mask: BoolArray, box: FloatArray) -> BoolArray:
    """The part of a mask (H, W) inside a box (4,) of x0, y0, x1, y1."""
    x0, y0, x1, y1 = np.clip(np.rint(box), 0, mask.shape[0]).astype(int)
    part = np.zeros_like(mask)
    part[y0:y1, x0:x1] = mask[y0:y1, x0:x1]
    return part


def _box_corners(row: FloatArray) -> FloatArray:
    x, y, length, width, _, _, radians = row
    cos, sin = np.cos(radians), np.sin(radians)
    corners = np.array([[-1, -1], [-1, 1], [1, 1], [1, -1]]) * (length / 2, width / 2)
    return corners @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
