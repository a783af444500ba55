"""Layouts as endless streams of training batches, made by worker processes as they are needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

from chord_usd.base.raster import canvas
from chord_usd.base.raster.table_top import draw_table
from chord_usd.base.scene.palette import Level
from chord_usd.base.scene.types import (
    BoolArray,
    Box,
    ByteArray,
    Item,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    SceneGraph,
)
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.draft import Draft
from chord_usd.line.layout.levels import traits_of
from chord_usd.line.layout.mosaic import Window, WindowSize, window_of, window_size
from chord_usd.workshop.data.augment import random_pose
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, training_seed
from chord_usd.workshop.data.tabletops import random_tabletop
from chord_usd.workshop.training.loader import batches_ahead

Batch = dict[str, Tensor]

_AT_HAND = 64
"""Furnished houses that are drawn from: what comes one after the other is seldom of one house."""

POOL_BATCHES = 4
"""Batches drawn ahead and sorted by size, so that layouts of a batch fill windows of one size."""


@dataclass(frozen=True)
class SeededConfig:
    """Settings of a stream."""

    seed: int = 0
    """Same seed, same data."""


@dataclass(frozen=True)
class StreamConfig(SeededConfig):
    """What the stream of houses draws from. Shares and chances are in [0, 1]."""

    real_share: float = 0.5
    """Share of houses on real floor plans, where there are any."""
    shading_chance: float = 0.5
    """Chance that rooms are shaded by kind; else the model must guess it."""
    margin_px: tuple[int, int] = (4, 28)
    """Free border of the canvas, which varies the scale."""
    procedural: int | None = None
    """How many different procedural houses; None for no two alike."""
    uses: int = 4
    """How often a furnished house is drawn on average, each time in another pose and draft."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """One layout on the whole canvas."""

    image: PlanImage
    """What it lies on."""
    labels: ByteArray
    front: BoolArray
    words: npt.NDArray[np.float32] | None = None
    """What is said of it, (words, channels)."""
    draft: Draft | None = None
    """What the network is shown of it, roughly."""


class BatchStream(IterableDataset[Batch]):
    """Batches of layouts and what they lie on, never ending; each worker has a random stream.

    A batch holds, for windows of height H and width W around what is drawn, rgb (B, H, W, 3) uint8
    and pixels (B, planes, H, W) uint8 and grid (B, planes, H/patch, W/patch) float32 of the
    condition, labels (B, H, W) uint8, front (B, H, W) bool and, where something is said of them,
    words (B, words, channels). Where there are drafts, draft_labels, draft_front and draft_known
    (B, H, W). Where the state is in colours, layout (B, H, W, 3) uint8.
    """

    config: SeededConfig
    pool_batches = POOL_BATCHES

    def __init__(self, network: LayoutConfig, batch: int) -> None:
        self.network = network
        self.traits = traits_of(network)
        self.batch = batch
        self._skipped = 0

    def draw(self, rng: np.random.Generator) -> Drawn:
        """One more layout of the training data."""
        raise NotImplementedError

    def held_out(self, count: int) -> list[Drawn]:
        """The first layouts that are never trained on; always the same."""
        raise NotImplementedError

    def held_out_batch(self, count: int) -> Batch:
        """Those layouts as a batch, on the largest canvas among them."""
        return self._batch([self._sized(drawn) for drawn in self.held_out(count)])

    def skip_to(self, step: int) -> None:
        """Go on with other data than that of the steps before."""
        self._skipped = step

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        seed = self.config.seed + self._skipped
        rng = np.random.default_rng((seed, worker.id if worker else 0))
        while True:
            pool = [self._sized(self.draw(rng)) for _ in range(self.batch * self.pool_batches)]
            pool.sort(key=lambda sized: sized[0])
            for first in rng.permutation(self.pool_batches) * self.batch:
                yield self._batch(pool[first : first + self.batch])

    def _sized(self, drawn: Drawn) -> tuple[WindowSize, Drawn]:
        if self.traits.whole:
            height, width = drawn.labels.shape
            return (height, width), drawn
        return window_size(drawn.image.rgb, self.network.window_multiple_px), drawn

    def _batch(self, sized: Sequence[tuple[WindowSize, Drawn]]) -> Batch:
        sizes = [size for size, _ in sized]
        size = (max(height for height, _ in sizes), max(width for _, width in sizes))
        samples = [self._sample(drawn, size) for _, drawn in sized]
        return {
            name: torch.from_numpy(np.stack([sample[name] for sample in samples]))
            for name in samples[0]
        }

    def _sample(self, drawn: Drawn, size: WindowSize) -> dict[str, np.ndarray]:
        image = drawn.image
        window = window_of(image.rgb, size)
        condition = self.traits.describe(
            image.rgb[window], image.frame.m_per_px, self.network.patch_px
        )
        painted: dict[str, np.ndarray] = {}
        if self.network.state == "rgb":
            painted["layout"] = self.traits.paint(image, drawn.labels, drawn.front)[window]
        return {
            "rgb": image.rgb[window],
            "pixels": condition.pixels,
            "grid": condition.grid,
            "labels": drawn.labels[window],
            "front": drawn.front[window],
            **painted,
            **({} if drawn.words is None else {"words": drawn.words}),
            **({} if drawn.draft is None else _draft_sample(drawn.draft, window)),
        }


def _draft_sample(draft: Draft, window: Window) -> dict[str, np.ndarray]:
    return {
        "draft_labels": draft.labels[window],
        "draft_front": draft.front[window],
        "draft_known": draft.known[window],
    }


class LayoutStream(BatchStream):
    """Furnished houses, procedural and on real floor plans, or somebody else's in place of them."""

    def __init__(
        self,
        config: StreamConfig,
        real_plans: Sequence[Plan],
        network: LayoutConfig,
        batch: int,
        furnished: Sequence[SceneGraph] = (),
        unseen: Sequence[SceneGraph] = (),
    ) -> None:
        """unseen: of the furnished ones, those that are held out."""
        super().__init__(network, batch)
        self.config: StreamConfig = config
        self.real_plans = real_plans
        self.furnished, self.unseen = furnished, unseen
        self._at_hand: list[SceneGraph] = []

    def __iter__(self) -> Iterator[Batch]:
        self._at_hand = []  # the same batches again
        return super().__iter__()

    def draw(self, rng: np.random.Generator) -> Drawn:
        """A house in a random pose, shaded by chance."""
        house = random_pose(self._house(rng), rng)
        frame = canvas.fit_frame(house.plan, margin_px=int(rng.integers(*self.config.margin_px)))
        shade = bool(rng.random() < self.config.shading_chance)
        drawn = _drawn_house(house, canvas.draw_plan(house.plan, frame, shade=shade))
        if not self.network.draft:
            return drawn
        return replace(drawn, draft=random_draft(house, frame, rng))

    def held_out(self, count: int) -> list[Drawn]:
        """Test houses, every other one shaded."""
        drawn = []
        for index in range(min(count, len(self.unseen)) if self.unseen else count):
            rng = np.random.default_rng(TEST_SEED + index)
            house = self.unseen[index] if self.unseen else furnish(random_plan(rng), rng)
            image = canvas.draw_plan(house.plan, shade=index % 2 == 0)
            draft = rough_draft(house, image.frame, rng) if self.network.draft else None
            drawn.append(replace(_drawn_house(house, image), draft=draft))
        return drawn

    def _house(self, rng: np.random.Generator) -> SceneGraph:
        """A house at hand, or a new one, which takes a place there, once in so many uses.

        To furnish one takes three quarters of the time of a sample.
        """
        if self.furnished or self.config.uses == 1:
            return self._furnished_house(rng)
        place = int(rng.integers(_AT_HAND))
        if len(self._at_hand) < _AT_HAND:
            self._at_hand.append(self._furnished_house(rng))
            place = -1
        elif rng.random() * self.config.uses < 1.0:
            self._at_hand[place] = self._furnished_house(rng)
        return self._at_hand[place]

    def _furnished_house(self, rng: np.random.Generator) -> SceneGraph:
        if self.furnished:
            return self.furnished[int(rng.integers(len(self.furnished)))]
        if self.real_plans and rng.random() < self.config.real_share:
            plan = self.real_plans[int(rng.integers(len(self.real_plans)))]
            return furnish(plan, rng)
        house_rng = np.random.default_rng(training_seed(rng, self.config.procedural))
        return furnish(random_plan(house_rng), house_rng)


def _drawn_house(house: SceneGraph, image: PlanImage) -> Drawn:
    return Drawn(image, *canvas.draw_items(house.items, image.frame))


@dataclass(frozen=True)
class TableStreamConfig(SeededConfig):
    """What the stream of tabletops draws from."""


class TableStream(BatchStream):
    """Procedural tabletops."""

    pool_batches = 16
    """A bedside table fills a tenth of what a dining table does."""

    def __init__(self, config: TableStreamConfig, network: LayoutConfig, batch: int) -> None:
        super().__init__(network, batch)
        self.config: TableStreamConfig = config

    def draw(self, rng: np.random.Generator) -> Drawn:
        """A laid supporting piece."""
        return _drawn_table(training_seed(rng))

    def held_out(self, count: int) -> list[Drawn]:
        """Test tabletops."""
        return [_drawn_table(TEST_SEED + index) for index in range(count)]


def _drawn_table(seed: int) -> Drawn:
    tabletop = random_tabletop(np.random.default_rng(seed))
    image = draw_table(tabletop.top)
    return Drawn(image, *canvas.draw_items(tabletop.items, image.frame, Level.TABLE))


def batch_loader(stream: BatchStream, workers: int) -> DataLoader[Batch]:
    """The stream's batches; with workers = 0 they are made in this process."""
    return batches_ahead(stream, workers, ahead=2 * POOL_BATCHES, pinned=torch.cuda.is_available())


# Drafts to learn from: a layout as a list network would list it, or part of it, or ---------------

# The layout network is to mend the errors of lists: places to a hand's breadth, sizes to a
# tenth. Now and then a piece is missing or one too many stands about, so that the picture stays the
# judge.


@dataclass(frozen=True)
class Roughness:
    """How drafts differ from what they are of."""

    place_m: float = 0.04
    """Standard deviation, along each axis."""
    size: float = 0.03
    """Of the logarithm of lengths and widths."""
    missing: float = 0.02
    """Chance of a piece not to be in the draft."""
    extra: float = 0.02
    """Chance of a piece to stand in the draft once more, somewhere near."""
    extra_m: float = 0.8
    """How far from the piece, a standard deviation."""


ROUGHNESS = Roughness()

NOTHING_KNOWN, ALL_KNOWN = 0.3, 0.5
"""Shares of houses without any draft, which the pure model is for, and with one for all rooms;
the others have drafts for some rooms."""


def random_draft(house: SceneGraph, frame: PixelFrame, rng: np.random.Generator) -> Draft:
    """What the network is shown of a house it learns from."""
    share = rng.random()
    rooms: Sequence[Room] = house.rooms
    if share < NOTHING_KNOWN:
        rooms = ()
    elif share > NOTHING_KNOWN + ALL_KNOWN:
        rooms = [room for room in rooms if rng.random() < rng.random()]
    return rough_draft(house, frame, rng, rooms)


def rough_draft(
    house: SceneGraph,
    frame: PixelFrame,
    rng: np.random.Generator,
    rooms: Sequence[Room] | None = None,
) -> Draft:
    """A draft of these rooms of a house, by default of all, as rough as lists are."""
    rooms = house.rooms if rooms is None else rooms
    ids = {room.id for room in rooms}
    items = [item for item in house.items if item.room_id in ids]
    return Draft.of(_rough(items, rng, ROUGHNESS), rooms, frame)


def _rough(items: Sequence[Item], rng: np.random.Generator, roughness: Roughness) -> Iterator[Item]:
    for item in items:
        if rng.random() >= roughness.missing:
            yield _moved(item, roughness.place_m, roughness.size, rng)
        if rng.random() < roughness.extra:
            yield _moved(item, roughness.extra_m, roughness.size, rng)


def _moved(item: Item, place_m: float, size: float, rng: np.random.Generator) -> Item:
    x, y = item.box.center_m[:2] + rng.normal(0.0, place_m, 2)
    length, width = item.box.size_m[:2] * np.exp(rng.normal(0.0, size, 2))
    center = (float(x), float(y), item.box.center_m[2])
    box = Box(center, (float(length), float(width), item.box.size_m[2]), item.box.yaw_deg)
    return replace(item, box=box)
