"""Layouts as others would paint them, and how well each way of reading does on them.

The truth is what was drawn. Ways of reading: boxes of the detector and colours together, as the
graph step does; colours without the detector; the detector's boxes without the colours.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import cv2
import numpy as np

from chord_usd.base.errors import SceneError
from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import ByteArray, Detection, Item, LayoutImage, frozen_array
from chord_usd.line.graph.detect import ItemDetector
from chord_usd.line.graph.extract import extract_graph
from chord_usd.line.graph.match import items_seen
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED
from chord_usd.workshop.data.spoilt_layouts import fray, patch
from chord_usd.workshop.evaluation.detector_cases import Case
from chord_usd.workshop.evaluation.detector_scores import StepScores, StepSums

Touch = Callable[[ByteArray, np.random.Generator], ByteArray]
"""What a painter does to a picture."""


def _as_drawn(rgb: ByteArray, _: np.random.Generator) -> ByteArray:
    return rgb


def _jpeg(rgb: ByteArray, _: np.random.Generator, quality: int) -> ByteArray:
    coded = cv2.imencode(".jpg", rgb[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.ascontiguousarray(cv2.imdecode(coded, cv2.IMREAD_COLOR)[..., ::-1])


def _blurred(rgb: ByteArray, _: np.random.Generator) -> ByteArray:
    return np.asarray(cv2.GaussianBlur(rgb, (0, 0), 1.0), np.uint8)


def _shifted(rgb: ByteArray, rng: np.random.Generator) -> ByteArray:
    """Another screen, another program: every channel with a gain and an offset of its own."""
    gain, offset = rng.uniform(0.93, 1.0, 3), rng.uniform(-6.0, 6.0, 3)
    return np.clip(rgb * gain + offset, 0, 255).astype(np.uint8)


def _by_hand(rgb: ByteArray, rng: np.random.Generator) -> ByteArray:
    """Brush strokes: corners round, edges that wander, paper that is never even."""
    rounded = cv2.medianBlur(rgb, 5)
    grain = cv2.GaussianBlur(rng.normal(0.0, 1.0, rgb.shape[:2]).astype(np.float32), (0, 0), 6.0)
    uneven = rounded + 5.0 * (grain / grain.std())[..., None]
    return np.clip(uneven, 0, 255).astype(np.uint8)


PAINTERS: Mapping[str, Touch] = {
    "as drawn": _as_drawn,
    "torn edges": _as_drawn,
    "JPEG 50": partial(_jpeg, quality=50),
    "blurred by 1 px": _blurred,
    "other colours": _shifted,
    "by hand": _by_hand,
}
TORN = frozenset(("torn edges", "by hand"))
"""Painters whose edges wander, as edges of networks do."""


def painted_cases(painter: str, count: int) -> Iterator[Case]:
    """Held-out houses as a painter leaves them."""
    for index in range(count):
        rng = np.random.default_rng(TEST_SEED + index)
        graph = furnish(random_plan(rng), rng)
        image = canvas.draw_plan(graph.plan)
        labels, front = canvas.draw_items(graph.items, image.frame)
        if painter in TORN:
            red, green, blue = np.moveaxis(image.rgb, -1, 0)
            floor = (red == green) & (green == blue) & (red > 0)
            labels, front = patch(*fray(labels, front, floor, rng), floor, rng)
        rgb = PAINTERS[painter](canvas.paint_layout(image, labels, front), rng)
        layout = LayoutImage(frozen_array(rgb, np.uint8), image.frame)
        yield Case(f"{TEST_SEED + index}", layout, graph.items, graph.plan, True)


class _Blind:
    def detect(self, rgb: ByteArray) -> list[Detection]:
        del rgb
        return []


def _by_graph(case: Case, detector: ItemDetector | _Blind) -> Sequence[Item]:
    return extract_graph(case.layout, case.plan, detector).items


def _by_boxes(case: Case, detector: ItemDetector) -> Sequence[Item]:
    return items_seen(detector.detect(case.layout.rgb), case.layout.frame)


def score_painters(
    detector: ItemDetector, count: int, progress: Progress | None = None
) -> dict[str, dict[str, StepScores]]:
    """By painter, then by way of reading; a layout that cannot be read has nothing found."""
    readers: Mapping[str, Callable[[Case], Sequence[Item]]] = {
        "both": lambda case: _by_graph(case, detector),
        "colours alone": lambda case: _by_graph(case, _Blind()),
        "detector alone": lambda case: _by_boxes(case, detector),
    }
    scores: dict[str, dict[str, StepScores]] = {}
    for number, painter in enumerate(PAINTERS):
        sums = {name: StepSums() for name in readers}
        for index, case in enumerate(painted_cases(painter, count)):
            for name, read in readers.items():
                try:
                    items = read(case)
                except SceneError:
                    items = ()
                sums[name].add(items, case.items, case.layout.frame.m_per_px)
            if progress:
                progress(number * count + index + 1, len(PAINTERS) * count)
        scores[painter] = {name: step_sums.scores() for name, step_sums in sums.items()}
    return scores


def as_markdown(scores: Mapping[str, Mapping[str, StepScores]]) -> str:
    """One row for each painter and way of reading."""
    lines = [
        "| painter | read by | recall | precision | fronts right | edges within 1 px |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {painter} | {name} | {step.recall:.4f} | {step.precision:.4f} | {step.orientation:.4f} "
        f"| {step.edges_within_1px:.4f} |"
        for painter, by in scores.items()
        for name, step in by.items()
    ]
    return "\n".join(lines) + "\n"
