"""Crops of crowded pages to learn from where furniture and fixtures are drawn."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor
from torch.utils.data import IterableDataset, get_worker_info

from chord_usd.base.raster.page_labels import PIECE_M_PER_PX, PIECE_NAMES, PIECE_STEP_PX
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import ByteArray, FloatArray
from chord_usd.workshop.data.drawn.crowded import draw_page
from chord_usd.workshop.data.drawn.no_plans import draw_no_plan
from chord_usd.workshop.data.drawn.page_looks import random_look
from chord_usd.workshop.data.drawn.truth import CrowdedPage
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed

Batch = tuple[Tensor, Tensor, Tensor, Tensor]
"""Colours (B, 3, S, S) uint8; hills about centres (B, K, C, C) uint8, 255 at a centre, C = S /
PIECE_STEP_PX; shapes (B, 6, C, C); (B, C, C) 1 where a shape is said, 2 where its front may be its
back, too."""

CROP_PX = 224
POOL = 40
CROPS = 6
"""Taken before another page takes a page's place, on average."""
NO_PLANS = 0.05
_BARE = 0.12
"""Share of pages without furniture that stay so."""
_KINDS = {"furnished": 0.4, "coloured": 0.2, "photoreal": 0.3, "pastel": 0.1}
"""Kinds of page that show much furniture; half of the pages are of these."""
_TILED, _FAINT, _WHITE = 0.25, 0.3, 235
"""Shares of pages whose wet rooms are tiled, and whose furniture is drawn in light grey, on paper
of this level or lighter."""
_ANYWHERE = 0.12
"""Share of crops that are not about a piece."""
_JITTER = 0.12
"""Of the scale, which is never known exactly: a standard deviation of its logarithm."""
_ENLARGED = 2.2
"""A page is not enlarged more than this."""
_SPREAD = 0.12
"""Of a hill, in the geometric mean of a piece's sides."""

_SAME = {
    "washing_set": "washbasin", "leisure_sofa": "single_sofa",
}  # fmt: skip
"""Categories that are drawn alike."""
_TURNED_ALIKE = ("dining_table", "coffee_table")
"""What looks the same from its back."""


@dataclass(frozen=True, eq=False)
class Crop:
    """A square piece of a page at PIECE_M_PER_PX, or nearly."""

    rgb: ByteArray
    pieces: FloatArray
    """(N, 7): index in PIECE_NAMES, centre (x, y), length and depth in pixels, and the direction of
    the front (x, y), y down."""


def pieces_of(page: CrowdedPage) -> FloatArray:
    """(N, 7) all pieces of a page as Crop has them, in its pixels."""
    rows = []
    for item in (item for storey in page.storeys for item in storey.pieces):
        name = _SAME.get(item.category, item.category)
        if name not in PIECE_NAMES:
            continue
        corners = footprint(item.box)
        seen = np.column_stack([corners, np.ones(4)]) @ page.to_picture.T
        back_left, front_left, front_right, back_right = seen[:, :2] / seen[:, 2:]
        middle = (back_left + front_left + front_right + back_right) / 4
        front = (front_left + front_right) / 2 - middle
        depth = 2 * float(np.hypot(*front))
        length = float(np.hypot(*((back_right + front_right - back_left - front_left) / 2)))
        rows.append((PIECE_NAMES.index(name), *middle, length, depth, *(2 * front / depth)))
    return np.array(rows, np.float64).reshape(-1, 7)


@dataclass(frozen=True, eq=False)
class _Page:
    """A page at the scale at which it is looked at."""

    rgb: ByteArray
    pieces: FloatArray


def _scaled(page: CrowdedPage, jitter: float) -> _Page:
    """Brought to PIECE_M_PER_PX times exp(jitter), by the scale in its middle."""
    height, width = page.labels.shape
    middle = np.linalg.solve(page.to_picture, [width / 2, height / 2, 1.0])
    steps = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]) + middle / middle[2]
    seen = steps @ page.to_picture.T
    seen = seen[:, :2] / seen[:, 2:]
    px_per_m = float(np.sqrt(abs(np.linalg.det(seen[1:] - seen[0]))))
    share = min(float(np.exp(jitter)) / PIECE_M_PER_PX / px_per_m, _ENLARGED)
    size = max(8, round(width * share)), max(8, round(height * share))
    way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_CUBIC
    pieces = pieces_of(page)
    pieces[:, 1:5] *= share
    return _Page(np.asarray(cv2.resize(page.rgb, size, interpolation=way), np.uint8), pieces)


def _crop(page: _Page, about: FloatArray, rng: np.random.Generator) -> Crop:
    """The square with a place somewhere in its middle."""
    spot = np.rint(about - rng.uniform(0.15, 0.85, 2) * CROP_PX).astype(int)
    paper = page.rgb[2, 2]
    picture = np.empty((CROP_PX, CROP_PX, 3), np.uint8)
    picture[:] = paper
    x, y = spot.tolist()
    left, top = max(0, -x), max(0, -y)
    part = page.rgb[max(0, y) : max(0, y + CROP_PX), max(0, x) : max(0, x + CROP_PX)]
    picture[top : top + part.shape[0], left : left + part.shape[1]] = part
    pieces = page.pieces.copy()
    pieces[:, 1:3] -= spot
    inside = np.all((pieces[:, 1:3] >= 0) & (pieces[:, 1:3] < CROP_PX), axis=1)
    return Crop(picture, pieces[inside])


def posed(crop: Crop, rng: np.random.Generator) -> Crop:
    """In one of eight poses, in other colours."""
    rgb, pieces = crop.rgb, crop.pieces.copy()
    if rng.random() < 0.5:
        rgb = rgb[:, ::-1]
        pieces[:, 1] = CROP_PX - pieces[:, 1]
        pieces[:, 5] *= -1
    if rng.random() < 0.5:
        rgb = rgb[::-1]
        pieces[:, 2] = CROP_PX - pieces[:, 2]
        pieces[:, 6] *= -1
    if rng.random() < 0.5:
        rgb = rgb.transpose(1, 0, 2)
        pieces[:, 1:3] = pieces[:, 2:0:-1]
        pieces[:, 5:7] = pieces[:, [6, 5]]
    if rng.random() < 0.3:
        rgb = rgb[..., rng.permutation(3)]
    if rng.random() < 0.3:
        curve = 255 * (np.arange(256) / 255) ** rng.uniform(0.6, 1.6)
        rgb = curve.astype(np.uint8)[rgb]
    return Crop(rgb, pieces)


def targets_of(pieces: FloatArray) -> tuple[ByteArray, npt.NDArray[np.float32], ByteArray]:
    """Hills about centres, shapes, and where shapes are said, as Batch has them."""
    cells = CROP_PX // PIECE_STEP_PX
    hills = np.zeros((len(PIECE_NAMES), cells, cells), np.uint8)
    shapes = np.zeros((6, cells, cells), np.float32)
    said = np.zeros((cells, cells), np.uint8)
    steps = np.arange(cells)
    for kind, x, y, length, depth, front_x, front_y in pieces:
        at = np.array([x, y]) / PIECE_STEP_PX
        column, row = (min(int(v), cells - 1) for v in at)
        spread = max(0.6, _SPREAD * float(np.sqrt(length * depth)) / PIECE_STEP_PX)
        across, down = ((steps - middle) ** 2 / (2 * spread**2) for middle in (column, row))
        hill = np.rint(255 * np.exp(-(down[:, None] + across))).astype(np.uint8)
        np.maximum(hills[int(kind)], hill, out=hills[int(kind)])
        shapes[:, row, column] = (
            *(at - (column, row)), np.log(max(length, 1)), np.log(max(depth, 1)), front_x, front_y
        )  # fmt: skip
        said[row, column] = 2 if PIECE_NAMES[int(kind)] in _TURNED_ALIKE else 1
    return hills, shapes, said


def batch_of(crops: Sequence[Crop]) -> Batch:
    """Crops side by side."""
    rgb = np.stack([crop.rgb.transpose(2, 0, 1) for crop in crops])
    hills, shapes, said = (
        np.stack(parts) for parts in zip(*(targets_of(crop.pieces) for crop in crops), strict=True)
    )
    tensors = [torch.from_numpy(np.ascontiguousarray(part)) for part in (rgb, hills, shapes, said)]
    return tensors[0], tensors[1], tensors[2], tensors[3]


def held_out(count: int) -> list[Crop]:
    """Crops of test pages about pieces, each category in its turn, always the same."""
    rng = np.random.default_rng(0)
    crops: list[Crop] = []
    page = 0
    while len(crops) < count:
        drawn = _scaled(_drawn(TEST_SEED + page, rng), rng.normal(0, 0.5 * _JITTER))
        page += 1
        rare = np.isin(drawn.pieces[:, 0], range(7))
        if rare.any():
            places = drawn.pieces[rare][:, 1:3]
            crops.append(_crop(drawn, places[int(rng.integers(len(places)))], rng))
    return crops


class SymbolStream(IterableDataset[Batch]):
    """Batches, never ending; each worker draws pages of its own."""

    def __init__(self, batch: int, seed: int, pool: int = POOL) -> None:
        self.batch, self.seed, self.pool = batch, seed, pool

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        rng = np.random.default_rng((self.seed, worker.id if worker else 0))
        pages: list[_Page] = []
        shown: Counter[int] = Counter()
        while True:
            crops = []
            for _ in range(self.batch):
                if len(pages) < self.pool:
                    pages.append(_page(rng))
                elif rng.random() < 1.0 / CROPS:
                    pages[int(rng.integers(self.pool))] = _page(rng)
                page, about = _picked(pages, shown, rng)
                crop = posed(_crop(page, about, rng), rng)
                shown.update(crop.pieces[:, 0].astype(int).tolist())
                crops.append(crop)
            yield batch_of(crops)


def _picked(
    pages: Sequence[_Page], shown: Counter[int], rng: np.random.Generator
) -> tuple[_Page, FloatArray]:
    """A page, and a place on it: of the category that was shown least, or anywhere."""
    page = pages[int(rng.integers(len(pages)))]
    kinds = sorted({int(kind) for page in pages for kind in page.pieces[:, 0]})
    if rng.random() < _ANYWHERE or not kinds:
        return page, rng.uniform(0, 1, 2) * page.rgb.shape[1::-1]
    weights = np.array([1.0 / (1 + shown[kind]) for kind in kinds])
    wanted = int(rng.choice(kinds, p=weights / weights.sum()))
    having = [page for page in pages if np.any(page.pieces[:, 0] == wanted)]
    page = having[int(rng.integers(len(having)))]
    places = page.pieces[page.pieces[:, 0] == wanted][:, 1:3]
    return page, places[int(rng.integers(len(places)))]


def _page(rng: np.random.Generator) -> _Page:
    seed = int(rng.integers(2**40))
    while is_test_seed(seed):
        seed = int(rng.integers(2**40))
    page = draw_no_plan(seed) if rng.random() < NO_PLANS else _drawn(seed, rng)
    return _scaled(page, rng.normal(0, _JITTER))


def _drawn(seed: int, rng: np.random.Generator) -> CrowdedPage:
    """A page of a seed, nearly always with furniture."""
    page_rng = np.random.default_rng((seed, 2))
    kind = (
        str(page_rng.choice(list(_KINDS), p=list(_KINDS.values())))
        if page_rng.random() < 0.5
        else None
    )
    look = random_look(page_rng, kind)
    if page_rng.random() < _TILED:
        look = replace(look, wet_tiles=1.0)
    if page_rng.random() < _FAINT and min(look.paper_rgb) > _WHITE:
        red, green, blue = (int(v) for v in np.full(3, page_rng.uniform(140, 215)))
        look = replace(look, piece_rgb=(red, green, blue))
    if look.pieces == "none" and rng.random() > _BARE:
        look = replace(look, pieces="lines")
    if look.only_fixtures and rng.random() < 0.5:
        look = replace(look, only_fixtures=False)
    return draw_page(seed, look, is_varied=True)
