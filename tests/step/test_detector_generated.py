"""Layouts of the layout model as training samples of the detector."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

import cv2
import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import CANVAS_PX, LayoutImage, PlanImage
from chord_usd.workshop.training.detector_data import CLEAN, stream
from chord_usd.workshop.training.detector_generated import generated_samples

HALF_PX = 8


@dataclass
class OneBed:
    """A layout model that paints one bed, where there is most room for it."""

    painted: list[int] = field(default_factory=list)
    middles: list[tuple[int, int]] = field(default_factory=list)
    """Row and column of each bed's middle."""

    def sample_batch(self, images: Sequence[PlanImage], seeds: Sequence[int]) -> list[LayoutImage]:
        self.painted += seeds
        return [self._painted(image) for image in images]

    def _painted(self, image: PlanImage) -> LayoutImage:
        red, green, blue = np.moveaxis(image.rgb, -1, 0)
        grey = (red == green) & (green == blue) & (red > 0)
        _, areas = cv2.connectedComponents(grey.astype(np.uint8), connectivity=4)
        floor = grey & (areas != areas[0, 0])
        depth = cv2.distanceTransform(floor.astype(np.uint8), cv2.DIST_C, 3)
        row, column = map(int, np.unravel_index(depth.argmax(), depth.shape))
        assert depth[row, column] > HALF_PX
        self.middles.append((row, column))
        labels = np.zeros((CANVAS_PX, CANVAS_PX), np.uint8)
        bed = slice(row - HALF_PX, row + HALF_PX), slice(column - HALF_PX, column + HALF_PX)
        labels[bed] = 1 + category("bed").detector_class
        front = np.zeros(labels.shape, np.bool_)
        return LayoutImage(canvas.paint_layout(image, labels, front), image.frame)


def test_what_colours_say_is_taught(tmp_path: Path) -> None:
    model = OneBed()
    samples = generated_samples(model, 3, tmp_path)  # type: ignore[arg-type]
    assert len(samples) == len(model.painted) == len(list(tmp_path.glob("*.png"))) == 3
    for sample, (row, column) in zip(samples, model.middles, strict=True):
        assert len(sample.boxes) == 1
        found, x, y, *sides, _ = sample.boxes[0]
        assert found == category("bed").detector_class
        assert np.allclose((x, y), (column, row), atol=1.0)
        assert np.allclose(sides, 2 * HALF_PX, atol=1.0)
    assert all(len(sample.room_classes) for sample in samples)


def test_what_was_painted_is_not_painted_again(tmp_path: Path) -> None:
    first = generated_samples(OneBed(), 2, tmp_path)  # type: ignore[arg-type]
    model = OneBed()
    again = generated_samples(model, 3, tmp_path)  # type: ignore[arg-type]
    assert len(model.painted) == 1
    assert all(np.array_equal(a.rgb, b.rgb) for a, b in zip(first, again, strict=False))


def test_every_second_sample_is_a_generated_one(tmp_path: Path) -> None:
    generated = generated_samples(OneBed(), 1, tmp_path)  # type: ignore[arg-type]
    rng = np.random.default_rng(0)
    seen = list(islice(stream(rng, CLEAN, "items", generated), 8))
    colours = np.unique(generated[0].rgb.reshape(-1, 3), axis=0)
    same = [np.array_equal(np.unique(s.rgb.reshape(-1, 3), axis=0), colours) for s in seen]
    assert same == [False, True] * 4
