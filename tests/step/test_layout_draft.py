"""Drafts: what the layout network is shown of a list, and where its walk begins then."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from chord_usd.base.raster import canvas
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.layout.checkpoint import Checkpoint
from chord_usd.line.layout.config import PRESETS
from chord_usd.line.layout.draft import DRAFT_PLANES, Draft
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.line.layout.transfer import take_up
from chord_usd.workshop.training.stream import rough_draft


@pytest.fixture(scope="module")
def pure() -> LayoutNetwork:
    torch.manual_seed(0)
    return LayoutNetwork(replace(PRESETS["default"], draft=False)).eval()


@pytest.fixture(scope="module")
def drafted(pure: LayoutNetwork) -> LayoutNetwork:
    network = LayoutNetwork(replace(PRESETS["default"], draft=True))
    take_up(network, pure)
    return network.eval()


def test_a_draft_is_known_in_its_rooms_only(furnished_house: SceneGraph) -> None:
    image = canvas.draw_plan(furnished_house.plan)
    room = furnished_house.rooms[0]
    draft = Draft.of(furnished_house.items_of(room.id), [room], image.frame)
    planes = draft.planes(28)
    inside = canvas.room_pixels(room, image.frame)
    assert planes.shape == (DRAFT_PLANES, *inside.shape)
    assert (np.abs(planes[:, inside]) == 1.0).all()
    assert not planes[:, ~inside].any()


def test_a_network_that_takes_up_one_without_drafts_says_the_same(
    pure: LayoutNetwork, drafted: LayoutNetwork, furnished_house: SceneGraph
) -> None:
    """Whatever the draft: what it means is to be learned."""
    image = canvas.draw_plan(furnished_house.plan)
    models = [
        LayoutModel(TorchDenoiser(Checkpoint(n, n.config), full=True)) for n in (pure, drafted)
    ]
    windows = models[0].windows([image])
    draft = rough_draft(furnished_house, image.frame, np.random.default_rng(0))
    seen = models[1]._seen(windows, [draft])
    plans = [
        models[0].plans([image], windows),
        models[1].plans([image], windows, drafts=seen),
    ]
    state = models[0]._noise([1], *plans[0].inside.shape[-2:])
    with torch.inference_mode():
        answers = [m.estimate(state, [500], p).output for m, p in zip(models, plans, strict=True)]
    assert np.allclose(*answers, atol=1e-3)


def test_the_walk_begins_late_where_all_floor_is_known(
    drafted: LayoutNetwork, furnished_house: SceneGraph
) -> None:
    model = LayoutModel(TorchDenoiser(Checkpoint(drafted, drafted.config)))
    image = canvas.draw_plan(furnished_house.plan)
    whole = Draft.of(furnished_house.items, furnished_house.rooms, image.frame)
    some = Draft.of(furnished_house.items, furnished_house.rooms[:1], image.frame)
    totals: list[int] = []
    for draft in (whole, some, None):
        model.sample_batch(
            [image],
            seeds=[0],
            steps=5,
            drafts=[draft],
            progress=lambda done, total: totals.append(total),
        )
    assert totals == [1] + [5] * 5 + [5] * 5


@pytest.mark.parametrize("steps", [1, 2])
def test_one_step_is_taken_at_least(
    drafted: LayoutNetwork, furnished_house: SceneGraph, steps: int
) -> None:
    model = LayoutModel(TorchDenoiser(Checkpoint(drafted, drafted.config)))
    image = canvas.draw_plan(furnished_house.plan)
    whole = Draft.of(furnished_house.items, furnished_house.rooms, image.frame)
    assert model.sample_batch([image], seeds=[0], steps=steps, drafts=[whole])
