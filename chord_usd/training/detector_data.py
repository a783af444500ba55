"""Layout rasters with boxes and room masks, drawn as they are needed, for training the detector.

Clean rasters teach little about what the diffusion model paints, so most samples are spoilt: edges
fray, marks and whole patches go missing, specks appear, colours drift, houses stand askew.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from chord_usd import raster
from chord_usd.data.augment import Pose, posed
from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.data.splits import TEST_SEED, is_test_seed
from chord_usd.graph.detect import ROOM_CLASSES
from chord_usd.palette import HOUSE_CATEGORIES, category
from chord_usd.types import (
    CANVAS_PX,
    BoolArray,
    ByteArray,
    FloatArray,
    Item,
    PixelFrame,
    Room,
    SceneGraph,
)
from chord_usd.units import px_from_m

MASK_STEP_PX = 4
"""Room masks have a quarter of the raster's resolution, as the network's own."""

_LEAST_SIDE_PX = 2.0
"""ultralytics leaves thinner boxes out of its loss."""


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
    """(CANVAS_PX / MASK_STEP_PX,) squared; 1 + index of the room, 0 elsewhere."""


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


def stream(rng: np.random.Generator, spoiling: Spoiling) -> Iterator[Sample]:
    """Samples without end, none of a test house."""
    while True:
        seed = int(rng.integers(2**40))
        if not is_test_seed(seed):
            yield draw_sample(house(seed), spoiling, rng)


def held_out(count: int, spoiling: Spoiling = CLEAN) -> Iterator[Sample]:
    """The first of the test houses, always the same."""
    for seed in range(TEST_SEED, TEST_SEED + count):
        yield draw_sample(house(seed), spoiling, np.random.default_rng((1, seed)))


def draw_sample(graph: SceneGraph, spoiling: Spoiling, rng: np.random.Generator) -> Sample:
    """Draw one house, spoilt by chance."""
    if rng.random() < spoiling.askew:
        graph = posed(graph, Pose(yaw_deg=float(rng.uniform(-45.0, 45.0))))
    frame = raster.fit_frame(graph.plan, margin_px=int(rng.integers(*spoiling.margin_px)))
    plan_image = raster.draw_plan(graph.plan, frame, shade=rng.random() >= spoiling.unshaded)
    items = () if rng.random() < spoiling.unfurnished else graph.items
    labels, front = raster.draw_items(items, frame)
    floor = plan_image.rgb.max(axis=-1) == plan_image.rgb.min(axis=-1)
    floor &= plan_image.rgb[..., 0] > 0
    if rng.random() < spoiling.frayed:
        labels, front = fray(labels, front, floor, rng)
    if rng.random() < spoiling.patchy:
        labels, front = patch(labels, front, floor, rng)
    rgb = raster.paint_layout(plan_image, labels, front)
    if rng.random() < spoiling.noisy:
        rgb = drift(rgb, rng)
    classes, boxes, room_map = _rooms(graph.rooms, frame)
    return Sample(rgb, _boxes(items, frame), classes, boxes, room_map)


def fray(
    labels: ByteArray, front: BoolArray, floor: BoolArray, rng: np.random.Generator
) -> tuple[ByteArray, BoolArray]:
    """Edges that wander by a pixel or two: each pixel is read a little beside itself."""
    reach = rng.uniform(0.3, 1.6)
    wander = rng.normal(0.0, 1.0, (2, *labels.shape)).astype(np.float32)
    grain = float(rng.uniform(0.4, 1.5))
    offsets = [cv2.GaussianBlur(plane, (0, 0), grain) for plane in wander]
    rows, columns = np.indices(labels.shape)
    last = labels.shape[0] - 1
    row = np.clip(np.rint(rows + reach * offsets[0] / offsets[0].std()), 0, last).astype(int)
    column = np.clip(np.rint(columns + reach * offsets[1] / offsets[1].std()), 0, last).astype(int)
    moved = np.where(floor, labels[row, column], 0).astype(np.uint8)
    return moved, front[row, column] & (moved > 0)


def patch(
    labels: ByteArray, front: BoolArray, floor: BoolArray, rng: np.random.Generator
) -> tuple[ByteArray, BoolArray]:
    """Holes, lost marks, marks too many and specks of any category."""
    labels, front = labels.copy(), front.copy()
    for _ in range(int(rng.integers(3, 30))):
        row, column = rng.integers(0, CANVAS_PX, 2)
        height, width = rng.integers(1, 4, 2)
        spot = (slice(row, row + height), slice(column, column + width))
        kind = rng.integers(4)
        if kind == 0:
            labels[spot] = 0
        elif kind == 1:
            front[spot] = False
        elif kind == 2:
            front[spot] = True
        else:
            labels[spot] = rng.integers(1, len(HOUSE_CATEGORIES) + 1)
    labels = np.where(floor, labels, 0).astype(np.uint8)
    return labels, front & (labels > 0)


def drift(rgb: ByteArray, rng: np.random.Generator) -> ByteArray:
    """Colours as a JPEG file or a noisy source leaves them."""
    if rng.random() < 0.5:
        quality = int(rng.integers(70, 96))
        coded = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
        return np.ascontiguousarray(cv2.imdecode(coded, cv2.IMREAD_COLOR)[..., ::-1])
    reach = int(rng.integers(2, 9))
    noisy = rgb.astype(np.int16) + rng.integers(-reach, reach + 1, rgb.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def _boxes(items: tuple[Item, ...], frame: PixelFrame) -> FloatArray:
    rows = []
    for item in items:
        x, y = px_from_m(item.box.center_m[:2], frame)
        length, width = (max(side / frame.m_per_px, _LEAST_SIDE_PX) for side in item.box.size_m[:2])
        quarters, rest = divmod(-item.box.yaw_deg + 45.0, 90.0)
        if int(quarters) % 2:
            length, width = width, length
        rows.append(
            [category(item.category).detector_class, x, y, length, width, np.radians(rest - 45.0)]
        )
    return np.array(rows, dtype=np.float64).reshape(-1, 6)


def _rooms(rooms: tuple[Room, ...], frame: PixelFrame) -> tuple[FloatArray, FloatArray, ByteArray]:
    """Classes, boxes and map of the rooms whose kind is known."""
    side = CANVAS_PX // MASK_STEP_PX
    room_map = np.zeros((side, side), dtype=np.uint8)
    classes, boxes = [], []
    for room in rooms:
        if room.kind == "unknown":
            continue
        corners = px_from_m(room.polygon_m, frame)
        low, high = corners.min(axis=0), corners.max(axis=0)
        classes.append(ROOM_CLASSES.index(room.kind))
        boxes.append([*(low + high) / 2, *(high - low)])
        # fillPoly counts pixel centres as whole numbers.
        points = np.rint((corners / MASK_STEP_PX - 0.5) * 16).astype(np.int32)
        cv2.fillPoly(room_map, [points], (len(classes),), shift=4)
    return (
        np.array(classes, dtype=np.float64),
        np.array(boxes, dtype=np.float64).reshape(-1, 4),
        room_map,
    )
