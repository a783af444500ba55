"""Floor plans as training batches: on blank sheets with words, or in open plans."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import bubbles_of, jittered, with_bubbles
from chord_usd.base.scene.geometry import is_axis_aligned
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import Plan, PlanImage
from chord_usd.base.scene.wish import Wish, floor_area_m2
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.planning.encoder import MiniLM, TextEncoder
from chord_usd.line.planning.floor_sheet import blank_sheet
from chord_usd.line.planning.words import PROGRAMME_CHANNELS, Words, condition_words
from chord_usd.workshop.data.descriptions import describe
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed
from chord_usd.workshop.training.stream import BatchStream, Drawn, SeededConfig


@dataclass(frozen=True)
class FloorStreamConfig(SeededConfig):
    """What the stream of floor plans draws from. Shares and chances are in [0, 1]."""

    condition: str = "text"
    """text: on a blank sheet; outline: in an open plan."""
    real_share: float = 0.3
    """Share of real floor plans, where there are any."""
    text_chance: float = 0.5
    """Chance that the words of a text are seen, beside the programme that they stand for."""
    wish_chance: float = 0.5
    """Chance that a programme is given with an open plan."""
    silent_chance: float = 0.1
    """Chance that a sheet comes without a word: a house for no wish at all."""
    bubble_chance: float = 0.9
    """Chance that a bubble diagram of the rooms is on the sheet."""


# Threads of a process do not follow it into its workers, so there is one.
_minilm = partial(MiniLM, threads=1)


class FloorStream(BatchStream):
    """Floor plans, procedural and real."""

    pool_batches = 1
    """All of a size."""

    def __init__(
        self,
        config: FloorStreamConfig,
        real_plans: Sequence[Plan],
        network: LayoutConfig,
        batch: int,
        load_encoder: Callable[[], TextEncoder] = _minilm,
    ) -> None:
        """load_encoder: called in the process that draws, where a text is first read."""
        super().__init__(network, batch)
        self.config: FloorStreamConfig = config
        self.real_plans = [plan for plan in real_plans if _is_plain(plan)]
        self._load_encoder = load_encoder
        self._encoder: TextEncoder | None = None
        self._text_channels = network.word_channels - PROGRAMME_CHANNELS

    def __getstate__(self) -> dict[str, Any]:
        """The stream for another process, which loads the encoder itself: sessions stay."""
        return {**self.__dict__, "_encoder": None}

    def draw(self, rng: np.random.Generator) -> Drawn:
        """One more floor plan, and what is said of it."""
        while True:
            drawn = self._drawn(self._plan(rng), rng)
            if drawn is not None:
                return drawn

    def held_out(self, count: int) -> list[Drawn]:
        """The first test plans that fit their sheets."""
        drawn: list[Drawn] = []
        seed = TEST_SEED
        while len(drawn) < count:
            rng = np.random.default_rng(seed)
            house = self._drawn(random_plan(rng), rng)
            drawn += [house] if house else []
            seed += 1
        return drawn

    def _plan(self, rng: np.random.Generator) -> Plan:
        if self.real_plans and rng.random() < self.config.real_share:
            plan = self.real_plans[int(rng.integers(len(self.real_plans)))]
            return posed(plan, Pose(bool(rng.integers(2)), 1.0, 90.0 * int(rng.integers(4))))
        seed = int(rng.integers(2**40))
        while is_test_seed(seed):
            seed = int(rng.integers(2**40))
        return random_plan(np.random.default_rng(seed))

    def _drawn(self, plan: Plan, rng: np.random.Generator) -> Drawn | None:
        """The plan on its sheet; None where it does not fit, or cannot be said in words."""
        if self.config.condition == "text" and not is_axis_aligned(plan):
            return None
        scale = self._scale(plan)
        if scale is None:
            return None
        frame = plan_labels.label_frame(plan, scale)
        labels = plan_labels.label_plan(plan, frame)
        sheet = blank_sheet(frame)
        if self.config.condition == "outline":
            shell = plan_labels.open_plan(labels, scale)
            sheet = PlanImage(plan_labels.paint_labels(shell), frame)
        if rng.random() < self.config.bubble_chance:
            sheet = with_bubbles(sheet, jittered(bubbles_of(plan), rng))
        return Drawn(sheet, labels, np.zeros(labels.shape, bool), self._words(plan, rng))

    def _scale(self, plan: Plan) -> float | None:
        finest = plan_labels.fitting_scale(plan)
        if self.config.condition == "outline" or finest is None:
            return finest
        scale = plan_labels.scale_for_area(floor_area_m2(plan))
        return scale if scale >= finest else None

    def _words(self, plan: Plan, rng: np.random.Generator) -> Words:
        said = describe(plan, rng)
        if self.config.condition == "outline":
            # Its walls say how large it is.
            wish = replace(said.wish, area_m2=None)
            return self._conditions(wish if rng.random() < self.config.wish_chance else Wish())
        if rng.random() < self.config.silent_chance:
            return self._conditions(Wish())
        if rng.random() >= self.config.text_chance:
            return self._conditions(said.wish)
        self._encoder = self._encoder or self._load_encoder()
        return self._conditions(said.wish, self._encoder.encode([said.text])[0])

    def _conditions(self, wish: Wish, text: npt.NDArray[np.float32] | None = None) -> Words:
        return condition_words(wish, text, self._text_channels)


def _is_plain(plan: Plan) -> bool:
    """Whether every room's kind is known and the house can be entered."""
    doors = [opening for opening in plan.openings if opening.kind == "door"]
    return bool(doors) and all(room.kind != "unknown" for room in plan.rooms)
