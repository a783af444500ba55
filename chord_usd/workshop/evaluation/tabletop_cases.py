"""Pieces to be laid: procedural pieces that come with their items, and pieces of houses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.raster.relief import Relief, Reliefs
from chord_usd.base.raster.table_top import draw_table
from chord_usd.base.scene.palette import Level, category
from chord_usd.base.scene.types import Box, Item, LayoutImage, PlanImage
from chord_usd.line.graph.match import Database, match_assets
from chord_usd.line.graph.tabletop import View, table_views
from chord_usd.line.layout.outlier import NoiseError
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.schedule import alphas_cumprod, noised
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED
from chord_usd.workshop.data.tabletops import random_tabletop


@dataclass(frozen=True, eq=False)
class Case:
    """A supporting piece under its name."""

    id: str
    view: View
    truth: tuple[Item, ...] | None = None
    """What the training data's own rules lay on it; None where nobody has."""

    @property
    def image(self) -> PlanImage:
        """The top view that the model draws over."""
        return draw_table(self.view.top)

    @property
    def drawn(self) -> LayoutImage:
        """The raster of the truth."""
        return canvas.layout_image(self.image, self.truth or (), Level.TABLE)


def procedural_cases(count: int) -> list[Case]:
    """The first procedural tops that are never trained on, as blocks of the usual height."""
    cases = []
    for seed in range(TEST_SEED, TEST_SEED + count):
        tabletop = random_tabletop(np.random.default_rng(seed))
        top = tabletop.top
        height_m = sum(category(top.category).height_m) / 2
        size_m = (*top.size_m, height_m)
        item = Item(f"{top.category}_{seed}", top.category, Box((0.0, 0.0, 0.0), size_m, 0.0))
        view = View(item, top, Relief(top.free * height_m, size_m), ())
        cases.append(Case(f"tabletop/{seed}", view, tabletop.items))
    return cases


def house_cases(database: Database, reliefs: Reliefs, count: int) -> list[Case]:
    """The supporting pieces of the first held-out houses, furnished as homes, with meshes.

    Pieces on which nothing fits are left out. Raises AssetError.
    """
    cases = []
    for seed in range(TEST_SEED, TEST_SEED + count):
        rng = np.random.default_rng(seed)
        house = match_assets(furnish(random_plan(rng), rng), database)
        cases += [
            Case(f"procedural/{seed}/{view.item.id}", view)
            for view in table_views(house, reliefs)
            if not view.is_too_small
        ]
    return cases


def redrawn(model: LayoutModel, cases: Sequence[Case], noise_to_signal: float) -> list[LayoutImage]:
    """The truth under noise, denoised by the model in one step.

    Such a raster has the soft edges and the specks of a sample, and yet its truth is known.
    """
    time = NoiseError(model).time_of(noise_to_signal)
    return [_redrawn(model, case, time, seed) for seed, case in enumerate(cases)]


def _redrawn(model: LayoutModel, case: Case, time: int, seed: int) -> LayoutImage:
    image = case.image
    labels, front = canvas.draw_items(case.truth or (), image.frame, Level.TABLE)
    window = model.windows([image])[0]
    clean = model.encode(labels[window], front[window], image.rgb[window])
    noise = np.random.default_rng(seed).standard_normal(clean.shape, np.float32)
    state = noised(clean, noise, float(alphas_cumprod(model.config)[time]))
    output = model.estimate(state, [time], model.plans([image], [window])).output[0]
    labels[:], front[:] = 0, False
    labels[window] = output[:-1].argmax(axis=0)
    front[window] = (output[-1] > 0) & (labels[window] > 0)
    rgb = canvas.paint_layout(image, labels, front, Level.TABLE)
    rgb.setflags(write=False)
    return LayoutImage(rgb, image.frame)
