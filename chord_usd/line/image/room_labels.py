"""Names and areas of rooms, written on pictures from straight above."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw
from shapely.geometry import Polygon

from chord_usd.base.raster.lettering import text_size, write_text
from chord_usd.base.runtime.stages import open_stage, room_prims
from chord_usd.base.scene.geometry import free_spot
from chord_usd.line.image.stage_cameras import StageCamera
from chord_usd.line.image.walkthrough import footprint_m

if TYPE_CHECKING:
    from pxr import Usd

_LETTERS_ACROSS, _LEAST_PX = 64, 8
"""Letters are as high as a part of the picture's width, and no smaller in narrow rooms."""
_INK, _HALO = (28, 30, 34), (250, 250, 250)


@dataclass(frozen=True)
class RoomLabel:
    """What is written on a room. Lengths are metres of the stage's world."""

    text: str
    at_m: tuple[float, float, float]
    """On its floor, furthest from walls and furniture."""
    across_m: tuple[float, float]
    """Where the room begins and ends along x."""


def read_labels(path: Path) -> tuple[RoomLabel, ...]:
    """A label for each room with an outline. Raises StageError."""
    from pxr import Usd, UsdGeom

    labels = []
    stage = open_stage(path)
    rooms = room_prims(stage)
    for room, name in zip(rooms, _names(rooms), strict=True):
        if not room.HasAttribute("chord:polygon_m"):
            continue
        floor = Polygon(np.array(room.GetAttribute("chord:polygon_m").Get()))
        place = UsdGeom.Xformable(room).ComputeLocalToWorldTransform(Usd.TimeCode.Default())
        floor_m = place.ExtractTranslation()[2]
        taken = [
            shape
            for prim in Usd.PrimRange(room)
            if prim.HasAttribute("chord:size_m") and not prim.HasAttribute("chord:rooms")
            for shape in footprint_m(prim, floor_m=floor_m)
        ]
        x_m, y_m = free_spot(floor, taken)
        words = f"{name}\n{floor.area:.1f} m²"
        labels.append(RoomLabel(words, (x_m, y_m, floor_m), floor.bounds[::2]))
    return tuple(labels)


def write_labels(picture: Image.Image, view: StageCamera, labels: Sequence[RoomLabel]) -> None:
    """Write the labels of the view's storey on a picture (RGB) that shows rooms as plans do."""
    if not _is_plan(view):
        return
    draw, middle_m = ImageDraw.Draw(picture), [row[3] for row in view.matrix[:2]]
    px_per_m = picture.width / view.aperture_m
    below = [label for label in labels if label.at_m[2] < view.cut_m]
    floor_m = max((label.at_m[2] for label in below), default=0.0)
    for label in (label for label in below if label.at_m[2] == floor_m):
        low, high = (picture.width / 2 + (x - middle_m[0]) * px_per_m for x in label.across_m)
        size_px = max(picture.width // _LETTERS_ACROSS, _LEAST_PX)
        while size_px > _LEAST_PX and text_size(label.text, size_px)[0] > high - low:
            size_px -= 1
        half_px = min(text_size(label.text, size_px)[0], high - low) / 2
        x, y = ((at - middle) * px_per_m for at, middle in zip(label.at_m, middle_m, strict=False))
        x_px = float(np.clip(picture.width / 2 + x, low + half_px, high - half_px))
        write_text(draw, (x_px, picture.height / 2 - y), label.text, size_px, _INK, "mm", _HALO)


def _names(rooms: Sequence[Usd.Prim]) -> list[str]:
    """Names as on plans; rooms of one kind without a name get numbers, from 1."""
    named = [
        "" if room.GetDisplayName() in ("", room.GetName()) else room.GetDisplayName()
        for room in rooms
    ]
    kinds = [re.sub(r"\B([A-Z])", r" \1", room.GetName().partition("_")[0]) for room in rooms]
    count = Counter(kind for kind, name in zip(kinds, named, strict=True) if not name)
    numbers: Counter[str] = Counter()
    for at, kind in enumerate(kinds):
        if not named[at]:
            numbers[kind] += 1
            number = f" {numbers[kind]}" if count[kind] > 1 else ""
            named[at] = f"{kind.capitalize()}{number}"
    return named


def _is_plan(view: StageCamera) -> bool:
    """Whether a view is cut open, from straight above, with +y up."""
    upright = np.allclose(np.array(view.matrix)[:3, :3], np.eye(3), atol=1e-6)
    return view.orthographic and view.cut_m > 0.0 and bool(upright)
