"""Crowded pages to learn reading from: drawn for ever by worker processes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Queue
from typing import TYPE_CHECKING

import cv2
import numpy as np
import torch
import torch.multiprocessing as processes

from chord_usd.data.drawn.crowded import draw_page
from chord_usd.data.drawn.no_plans import draw_no_plan
from chord_usd.data.drawn.truth import CrowdedPage
from chord_usd.data.splits import is_test_seed
from chord_usd.raster.page_labels import KIND_NAMES
from chord_usd.scene.types import ByteArray, FloatArray, Plan

if TYPE_CHECKING:
    from multiprocessing.process import BaseProcess

NO_KIND = 255

NO_PLANS = 0.06
"""Share of pages that show no plan."""

FLATS = 0.2
"""Share of pages that show real flats, where there are any."""

_SPOTS = 64
"""Pixels of a page that are remembered as lying in something built."""
_WAITING = 4
"""Pages of each worker that may wait to be taken."""


@dataclass(frozen=True, eq=False)
class LabelledPage:
    """A page and what is learned of it, pixel by pixel."""

    rgb: ByteArray
    """(H, W, 3)."""
    labels: ByteArray
    """(H, W), as CrowdedPage has them."""
    kinds: ByteArray
    """(H, W) of floors: index in KIND_NAMES, or NO_KIND."""
    points: FloatArray
    """(P, 3), as CrowdedPage has them."""
    spots: FloatArray
    """(S, 2) pixel x, y of some places where something is built; none where nothing is."""


def labelled(page: CrowdedPage, rng: np.random.Generator) -> LabelledPage:
    """The page with its kinds of floors painted."""
    inside = np.argwhere(page.labels)[:, ::-1]
    taken = rng.integers(len(inside), size=_SPOTS if len(inside) else 0)
    return LabelledPage(page.rgb, page.labels, _kinds(page), page.points, inside[taken] + 0.5)


def _kinds(page: CrowdedPage) -> ByteArray:
    found: ByteArray = np.full(page.labels.shape, NO_KIND, np.uint8)
    for room in (room for storey in page.storeys for room in storey.plan.rooms):
        if room.kind == "unknown":
            continue
        corners = np.column_stack([room.polygon_m, np.ones(len(room.polygon_m))])
        seen = corners @ page.to_picture.T
        pixels = np.rint(seen[:, :2] / seen[:, 2:] - 0.5).astype(np.int32)
        cv2.fillPoly(found, [pixels], (KIND_NAMES.index(room.kind),))
    return found


def random_page(rng: np.random.Generator, flats: Sequence[Plan] = ()) -> LabelledPage:
    """A page of a seed that is not held out. flats: plans to draw beside procedural ones."""
    seed = int(rng.integers(2**40))
    while is_test_seed(seed):
        seed = int(rng.integers(2**40))
    if rng.random() < NO_PLANS:
        return labelled(draw_no_plan(seed), rng)
    return labelled(draw_page(seed, flats=flats if rng.random() < FLATS else ()), rng)


# Workers -----------------------------------------------------------------------------------------


@contextmanager
def page_supply(
    workers: int, seed: int, flats: Sequence[Plan] = ()
) -> Iterator[Queue[LabelledPage]]:
    """A queue that worker processes fill while the block runs; they wait where it is full."""
    # Not by plain forks: OpenCV's threads do not live on in them.
    context = processes.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    supply = context.Queue(_WAITING * workers)
    drawing: list[BaseProcess] = [
        context.Process(target=_draw, args=(supply, (seed, worker), flats), daemon=True)
        for worker in range(workers)
    ]
    for process in drawing:
        process.start()
    try:
        yield supply
    finally:
        for process in drawing:
            process.kill()


def _draw(supply: Queue[LabelledPage], seed: tuple[int, int], flats: Sequence[Plan]) -> None:
    # OpenCV's own threads would fight the training for the same cores.
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    rng = np.random.default_rng(seed)
    while True:
        supply.put(random_page(rng, flats))
