"""Layout rasters with boxes and room masks, drawn as they are needed, for training the detector.

Clean rasters teach little about what the diffusion model paints, so most samples are spoilt: edges
fray, marks and whole patches go missing, specks appear, colours drift, houses stand askew.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import HOUSE_CATEGORIES, category
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import (
    CANVAS_PX,
    ByteArray,
    FloatArray,
    Item,
    PixelFrame,
    Room,
    SceneGraph,
)
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.graph.detect import IMAGE_PX, ROOM_CLASSES, Kind, taught_box
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed
from chord_usd.workshop.data.spoilt_layouts import drift, fray, patch

MASK_SIDE = IMAGE_PX["rooms"] // 4
"""Room masks are as fine as the network's own: a quarter of what it looks at."""

_SHELF = 192
"""Samples to choose the next one from: views of one drawing come far apart."""
_VIEWS, _RARE_VIEWS = 3, 6
"""How often a drawing is shown, each time turned or mirrored; the latter if it holds..."""
_RARE_SHARE = 0.3
"""...a class that so few houses have."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One layout raster and what is in it."""

    rgb: ByteArray
    """(CANVAS_PX, CANVAS_PX, 3)."""
    boxes: FloatArray
    """(N, 6) class, x, y, length, width in pixels, radians clockwise in [-pi/4, pi/4)."""
    room_classes: FloatArray
    """(R,) class of each room."""
    room_boxes: FloatArray
    """(R, 4) x, y, width, height in pixels."""
    room_map: ByteArray
    """(MASK_SIDE, MASK_SIDE); 1 + index of the room, 0 elsewhere."""

    def classes(self, kind: Kind) -> FloatArray:
        """(N,) the class of each item or room."""
        return self.boxes[:, 0] if kind == "items" else self.room_classes


@dataclass(frozen=True)
class Spoiling:
    """Chances, [0, 1], of each way in which a sample is spoilt."""

    unshaded: float = 0.5
    askew: float = 0.25
    frayed: float = 0.5
    patchy: float = 0.3
    noisy: float = 0.4
    unfurnished: float = 0.0
    margin_px: tuple[int, int] = (3, 40)


CLEAN = Spoiling(0.5, 0.0, 0.0, 0.0, 0.0, 0.0, (6, 7))
"""Rasters as the pipeline draws them, half of them unshaded: what scores are measured on."""


def house(seed: int) -> SceneGraph:
    """The furnished house of this seed."""
    rng = np.random.default_rng(seed)
    return furnish(random_plan(rng), rng)


def stream(
    rng: np.random.Generator,
    spoiling: Spoiling,
    kind: Kind = "items",
    generated: Sequence[Sample] = (),
) -> Iterator[Sample]:
    """Samples without end, none of a test house.

    Drawing costs half as much as learning from it, so each drawing is shown in several views;
    those with classes that few houses have, in more. generated: painted by the layout model; where
    there are any, every second sample is one of them.
    """
    drawn = _drawn_stream(rng, spoiling, kind)
    while True:
        yield next(drawn)
        if generated:
            chosen = generated[int(rng.integers(len(generated)))]
            yield turned(chosen, int(rng.integers(4)), bool(rng.integers(2)))


def _drawn_stream(rng: np.random.Generator, spoiling: Spoiling, kind: Kind) -> Iterator[Sample]:
    holding = np.zeros(max(len(HOUSE_CATEGORIES), len(ROOM_CLASSES)))
    drawn = 0
    shelf: list[Sample] = []
    while True:
        while len(shelf) < _SHELF:
            seed = int(rng.integers(2**40))
            if is_test_seed(seed):
                continue
            sample = draw_sample(house(seed), spoiling, rng)
            classes = np.unique(sample.classes(kind)).astype(int)
            drawn += 1
            holding[classes] += 1
            rare = (holding[classes] < _RARE_SHARE * drawn).any()
            shelf += [sample] * (_RARE_VIEWS if rare else _VIEWS)
        chosen = int(rng.integers(len(shelf)))
        shelf[chosen], shelf[-1] = shelf[-1], shelf[chosen]
        yield turned(shelf.pop(), int(rng.integers(4)), bool(rng.integers(2)))


def turned(sample: Sample, quarter_turns: int, mirrored: bool) -> Sample:
    """The sample turned counter-clockwise as seen, then mirrored left to right. Exact."""
    rgb, room_map = np.rot90(sample.rgb, quarter_turns), np.rot90(sample.room_map, quarter_turns)
    boxes, room_boxes = sample.boxes.copy(), sample.room_boxes.copy()
    for _ in range(quarter_turns % 4):
        boxes[:, 1:5] = boxes[:, [2, 1, 4, 3]]
        boxes[:, 2] = CANVAS_PX - boxes[:, 2]
        room_boxes = room_boxes[:, [1, 0, 3, 2]]
        room_boxes[:, 1] = CANVAS_PX - room_boxes[:, 1]
    if mirrored:
        rgb, room_map = rgb[:, ::-1], room_map[:, ::-1]
        boxes[:, 1], boxes[:, 5] = CANVAS_PX - boxes[:, 1], -boxes[:, 5]
        room_boxes[:, 0] = CANVAS_PX - room_boxes[:, 0]
    return replace(sample, rgb=rgb, boxes=boxes, room_boxes=room_boxes, room_map=room_map)


def held_out(count: int, spoiling: Spoiling = CLEAN) -> Iterator[Sample]:
    """The first of the test houses, always the same."""
    for seed in range(TEST_SEED, TEST_SEED + count):
        yield draw_sample(house(seed), spoiling, np.random.default_rng((1, seed)))


def draw_sample(graph: SceneGraph, spoiling: Spoiling, rng: np.random.Generator) -> Sample:
    """Draw one house, spoilt by chance."""
    if rng.random() < spoiling.askew:
        graph = posed(graph, Pose(yaw_deg=float(rng.uniform(-45.0, 45.0))))
    frame = canvas.fit_frame(graph.plan, margin_px=int(rng.integers(*spoiling.margin_px)))
    plan_image = canvas.draw_plan(graph.plan, frame, shade=rng.random() >= spoiling.unshaded)
    items = () if rng.random() < spoiling.unfurnished else graph.items
    labels, front = canvas.draw_items(items, frame)
    red, green, blue = np.moveaxis(plan_image.rgb, -1, 0)
    floor = (red == green) & (green == blue) & (red > 0)
    if rng.random() < spoiling.frayed:
        labels, front = fray(labels, front, floor, rng)
    if rng.random() < spoiling.patchy:
        labels, front = patch(labels, front, floor, rng)
    rgb = canvas.paint_layout(plan_image, labels, front)
    if rng.random() < spoiling.noisy:
        rgb = drift(rgb, rng)
    return sample_of(rgb, items, graph.rooms, frame)


def sample_of(
    rgb: ByteArray, items: tuple[Item, ...], rooms: tuple[Room, ...], frame: PixelFrame
) -> Sample:
    """A layout raster and what is known to be in it."""
    classes, boxes, room_map = _rooms(rooms, frame)
    return Sample(rgb, _boxes(items, frame), classes, boxes, room_map)


def _boxes(items: tuple[Item, ...], frame: PixelFrame) -> FloatArray:
    rows = [
        [category(item.category).detector_class, *taught_box(item.box, frame)] for item in items
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 6)


def _rooms(rooms: tuple[Room, ...], frame: PixelFrame) -> tuple[FloatArray, FloatArray, ByteArray]:
    """Classes, boxes and map of the rooms whose kind is known."""
    room_map = np.zeros((MASK_SIDE, MASK_SIDE), dtype=np.uint8)
    classes, boxes = [], []
    for room in rooms:
        if room.kind == "unknown":
            continue
        corners = px_from_m(room.polygon_m, frame)
        low, high = corners.min(axis=0), corners.max(axis=0)
        classes.append(ROOM_CLASSES.index(room.kind))
        boxes.append([*(low + high) / 2, *(high - low)])
        # fillPoly counts pixel centres as whole numbers.
        points = np.rint((corners * MASK_SIDE / CANVAS_PX - 0.5) * 16).astype(np.int32)
        cv2.fillPoly(room_map, [points], (len(classes),), shift=4)
    return (
        np.array(classes, dtype=np.float64),
        np.array(boxes, dtype=np.float64).reshape(-1, 4),
        room_map,
    )
