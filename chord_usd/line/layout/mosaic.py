"""Pictures too large for the network to look at, as one batch of views (views.cut_views).

All views look at one noisy state and step down together: at each step what a view says of its own
floor is put in its place, so that its neighbours see it at the next. Nothing has to be joined
afterwards, and no view comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import BoolArray, ByteArray
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.schedule import State
from chord_usd.line.layout.views import View, cut_views

VIEWS_AT_ONCE = 4
"""In one batch: more are no faster on a processor, and take more memory."""

Describe = Callable[[Sequence[ByteArray], Sequence[float], Sequence[State] | None], Plans]
"""Pictures of one size, their metres per pixel and drafts to what the network sees of them."""
Look = Callable[[State, Sequence[int], Plans], Estimate]
"""The network: of a noisy batch, its times and its plans."""


@dataclass(frozen=True, eq=False)
class _Batch:
    """Views of one size."""

    plans: Plans
    places: tuple[tuple[int, View], ...]
    """Of each view the index of its picture."""


@dataclass(frozen=True, eq=False)
class Mosaic:
    """A batch of large pictures, all of one size, as the views on them."""

    inside: BoolArray
    """(B, 1, H, W) floor; items exist nowhere else."""
    batches: tuple[_Batch, ...]

    def estimate(
        self, state: State, times: Sequence[int], look: Look, bare: tuple[State, State]
    ) -> Estimate:
        """What the views say of a noisy batch (B, C, H, W), each of its own floor.

        bare: output and clean state of what is no floor, (1, planes, 1, 1) each.
        """
        output, clean = (
            np.broadcast_to(of, (len(state), of.shape[1], *state.shape[2:])).copy() for of in bare
        )
        for batch in self.batches:
            parts = np.stack([state[index][:, *view.window] for index, view in batch.places])
            said = look(parts, [times[index] for index, _ in batch.places], batch.plans)
            assert said.clean is not None
            for place, (index, view) in enumerate(batch.places):
                for whole, part in ((output, said.output), (clean, said.clean)):
                    whole[index][:, *view.window][:, view.own] = part[place][:, view.own]
        return Estimate(output, clean)


def mosaic_of(
    pictures: Sequence[ByteArray],
    m_per_px: Sequence[float],
    multiple_px: int,
    describe: Describe,
    region: BoolArray | None = None,
    drafts: Sequence[State] | None = None,
) -> Mosaic:
    """Pictures (H, W, 3) of one size as a mosaic.

    multiple_px: of which the sides of pictures and views are multiples. region: (H, W) the floor
    that matters; views that decide about none of it are left out. drafts: (planes, H, W) of each.
    """
    inside = np.zeros((len(pictures), 1, *pictures[0].shape[:2]), np.bool_)
    places = []
    for index, (rgb, scale) in enumerate(zip(pictures, m_per_px, strict=True)):
        for view in cut_views(rgb, scale, multiple_px):
            inside[index, 0][view.window] |= view.own
            if region is None or (region[view.window] & view.own).any():
                places.append((index, view))
    return Mosaic(inside, tuple(_batches(places, m_per_px, describe, drafts)))


def _batches(
    places: Sequence[tuple[int, View]],
    m_per_px: Sequence[float],
    describe: Describe,
    drafts: Sequence[State] | None,
) -> Iterator[_Batch]:
    for size in dict.fromkeys(view.own.shape for _, view in places):
        group = [place for place in places if place[1].own.shape == size]
        for start in range(0, len(group), VIEWS_AT_ONCE):
            part = group[start : start + VIEWS_AT_ONCE]
            scales = [m_per_px[index] for index, _ in part]
            seen = drafts and [drafts[index][:, *view.window] for index, view in part]
            yield _Batch(describe([view.rgb for _, view in part], scales, seen), tuple(part))
