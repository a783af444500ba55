"""The table level with its real libraries: training, tops of meshes, whole houses."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.errors import AssetError, CheckpointError
from chord_usd.base.metrics.overlap import scene_overlap
from chord_usd.base.raster.table_top import TableTop, draw_table
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import SUPPORTS, TABLE_CATEGORIES, category
from chord_usd.base.scene.types import Asset, Box, Item, SceneGraph
from chord_usd.library.asset_shapes import relief_of
from chord_usd.library.database import AssetDatabase, load_database
from chord_usd.line.graph.match import match_assets
from chord_usd.line.graph.tabletop import table_views
from chord_usd.line.layout.checkpoint import load_checkpoint
from chord_usd.line.layout.config import PRESETS, TABLE, LayoutConfig
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.transfer import adopt
from chord_usd.line.pipeline import Settings, lay_tables
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.tabletops import lay
from chord_usd.workshop.data.tabletops.board import Outline
from chord_usd.workshop.data.tabletops.tops import Piece
from chord_usd.workshop.training.sheets import draw_sheet
from chord_usd.workshop.training.stream import TableStream, TableStreamConfig, batch_loader
from chord_usd.workshop.training.trainer import LayoutTrainer, TrainingConfig

TINY = replace(
    TABLE, channels=(16, 32), attention=(False, False), feature_channels=16, default_steps=2
)
TINY_HOUSE = replace(TINY, level="house")
QUICK = TrainingConfig(minutes=0.02, batch=4, workers=0, warmup_steps=5, learning_rate=3e-3)


def stream(seed: int = 0, batch: int = 4, config: LayoutConfig = TINY) -> TableStream:
    return TableStream(TableStreamConfig(seed), config, batch)


class TestTraining:
    def test_one_batch_is_learned(self, tmp_path: Path) -> None:
        trainer = LayoutTrainer(TINY, replace(QUICK, minutes=30.0), tmp_path)
        batch = next(iter(batch_loader(stream(), workers=0)))
        losses = [float(trainer._step(batch)["loss"].detach()) for _ in range(40)]
        assert np.mean(losses[-8:]) < 0.6 * np.mean(losses[:5])

    def test_a_run_leaves_a_checkpoint_of_its_level(self, tmp_path: Path, monkeypatch) -> None:
        monkeypatch.setattr(LayoutTrainer, "_draw_sheet", lambda _self, _stream: None)
        LayoutTrainer(TINY, QUICK, tmp_path).train(stream(), lambda row: None)
        loaded = load_checkpoint(tmp_path / "checkpoint")
        assert loaded.config.level == "table"
        assert loaded.training["data"] == {"seed": 0}
        assert LayoutTrainer(TINY, QUICK, tmp_path).resume()

    def test_batches_hold_what_the_network_needs(self) -> None:
        batch = next(iter(batch_loader(stream(batch=6), workers=0)))
        height, width = batch["labels"].shape[1:]
        assert height % TINY.window_multiple_px == width % TINY.window_multiple_px == 0
        assert int(batch["labels"].max()) <= len(TABLE_CATEGORIES)
        assert bool((batch["labels"][batch["front"]] > 0).all()), "marks lie on items"
        top = batch["pixels"][:, 0] > 0
        assert bool((top | (batch["labels"] == 0)).float().mean() > 0.999), "items lie on tops"

    def test_held_out_tables_are_always_the_same_and_never_drawn(self) -> None:
        one, other = stream(0).held_out(3), stream(1).held_out(3)
        for first, second in zip(one, other, strict=True):
            assert np.array_equal(first.labels, second.labels)
        rng = np.random.default_rng(0)
        drawn = [stream().draw(rng) for _ in range(20)]
        assert not any(np.array_equal(one[0].labels, other.labels) for other in drawn)

    def test_a_sheet_shows_tables(self, tmp_path: Path) -> None:
        network = LayoutNetwork(TINY).eval().requires_grad_(False)
        draw_sheet(network, tmp_path / "sheet.png", torch.device("cpu"), stream().held_out(2))
        assert (tmp_path / "sheet.png").stat().st_size > 1000

    def test_a_network_of_houses_gives_what_fits(self) -> None:
        """Code words, noise and shapes stay; what a condition means starts anew."""
        torch.manual_seed(0)
        house, table = LayoutNetwork(TINY_HOUSE), LayoutNetwork(TINY)
        adopt(table, house)
        fold = TINY.patch_px**2
        shared = min(len(table.head.weight), len(house.head.weight)) // fold - 1
        assert torch.equal(table.head.weight[: shared * fold], house.head.weight[: shared * fold])
        assert torch.equal(table.head.weight[-fold:], house.head.weight[-fold:]), "front marks"
        same = [
            name for name, tensor in house.state_dict().items()
            if name.startswith("unet") and torch.equal(tensor, table.state_dict()[name])
        ]  # fmt: skip
        assert len(same) == sum(name.startswith("unet") for name in house.state_dict())

    def test_a_network_built_otherwise_is_refused(self) -> None:
        with pytest.raises(CheckpointError, match="built differently"):
            adopt(LayoutNetwork(TINY), LayoutNetwork(replace(TINY_HOUSE, channels=(16, 48))))
        house = PRESETS["default"]
        apart = ("level", "draft", "default_steps", "default_sampler", "front_amplitude")
        assert replace(TABLE, **{name: getattr(house, name) for name in apart}) == house


@pytest.fixture(scope="module")
def database() -> AssetDatabase:
    return load_database()


class TestTops:
    @pytest.mark.parametrize("name", SUPPORTS)
    def test_the_top_of_every_supporting_mesh_is_found(
        self, name: str, database: AssetDatabase
    ) -> None:
        """Level, within the piece's height, and most of what is seen from above."""
        row = category(name)
        size_m = tuple(sum(span) / 2 for span in (row.length_m, row.width_m, row.height_m))
        relief = relief_of(database.nearest(name, size_m))
        assert 0.5 * relief.size_m[2] < relief.level_m <= relief.size_m[2] + 0.01
        assert relief.free.mean() > 0.4

    def test_the_rim_of_a_round_top_carries_nothing(self, database: AssetDatabase) -> None:
        """Its colliders stop short of it, and a vase there fell in a simulator."""
        relief = relief_of(database.named("Side_Table_Pedestal_56x56"))
        seen = replace(relief, colliders_m=None).free
        assert 0.9 < relief.free.sum() / seen.sum() < 1.0

    def test_a_block_is_flat_to_its_edge(self, block: Asset) -> None:
        relief = relief_of(block)
        assert relief.level_m == pytest.approx(block.size_m[2])
        assert relief.free.mean() > 0.98

    def test_a_file_that_is_no_stage_is_named(self, tmp_path: Path) -> None:
        broken = tmp_path / "broken.usda"
        broken.write_text("no stage")
        with pytest.raises(AssetError, match=r"broken\.usda"):
            relief_of(Asset("x", "table", (1.0, 1.0, 1.0), broken))


class Layer:
    """A model that lays tables as the training data does, a rectangle on every top."""

    content_hash = "none"

    def __init__(self) -> None:
        self.batches: list[int] = []

    def things(self, tops, seeds, progress=None) -> list[list[Item]]:
        self.batches.append(len(tops))
        return [self._laid(top, seed) for top, seed in zip(tops, seeds, strict=True)]

    def _laid(self, top: TableTop, seed: int) -> list[Item]:
        """Cups and books in the middle half of the top."""
        length, width = (0.7 * side for side in top.size_m)
        piece = Piece("coffee_table", Outline(length, width, 0.0), ())
        return list(lay(piece, Dice(np.random.default_rng(seed))))


@pytest.fixture(scope="module")
def house(furnished_house: SceneGraph, database: AssetDatabase) -> SceneGraph:
    return match_assets(furnished_house, database)


class TestHouse:
    def test_all_tables_are_laid_in_one_batch_and_items_stand(
        self, house: SceneGraph, database: AssetDatabase
    ) -> None:
        model = Layer()
        laid = lay_tables(house, model, database, Settings(seed=1))
        views = table_views(house, relief_of)
        assert model.batches[0] == sum(not view.is_too_small for view in views)
        assert laid.items > 5
        assert scene_overlap(laid.graph).por <= scene_overlap(house).por
        reliefs = {view.item.id: view.relief for view in views}
        for piece in laid.graph.items:
            for child in piece.children:
                _assert_supported(child, piece, reliefs[piece.id].highest_m(child.box))

    def test_the_same_seed_lays_the_same_tables(
        self, house: SceneGraph, database: AssetDatabase
    ) -> None:
        def children(seed: int, rooms: tuple[str, ...] = ()) -> dict[str, list[tuple[str, Box]]]:
            laid = lay_tables(house, Layer(), database, Settings(seed=seed), rooms=rooms)
            return {
                item.id: [(child.id, child.box) for child in item.children]
                for item in laid.graph.items
            }

        one = children(1)
        assert one == children(1)
        assert one != children(2)
        room = next(item.room_id for item in house.items if one[item.id])
        alone = children(1, (room,))
        for item in house.items:
            assert alone[item.id] == (one[item.id] if item.room_id == room else [])

    def test_what_is_laid_already_stays(self, house: SceneGraph, database: AssetDatabase) -> None:
        laid = lay_tables(house, Layer(), database, Settings(seed=1)).graph
        again = lay_tables(laid, Layer(), database, Settings(seed=2)).graph
        for before, after in zip(laid.items, again.items, strict=True):
            if before.children:
                assert after.children == before.children

    def test_the_condition_is_the_top_of_the_mesh(self, house: SceneGraph) -> None:
        for view in table_views(house, relief_of):
            rgb = draw_table(view.top).rgb
            shown = (rgb[..., 0] == rgb[..., 1]) & (rgb[..., 0] < 250) & (rgb[..., 0] > 150)
            m2 = float(shown.sum()) * draw_table(view.top).frame.m_per_px ** 2
            length, width, _ = view.item.box.size_m
            assert m2 == pytest.approx(view.relief.free.mean() * length * width, rel=0.15, abs=0.01)


def _assert_supported(child: Item, piece: Item, top_m: float) -> None:
    """On the mesh below it, or on a sibling that lies underfoot."""
    under = [
        other.box.center_m[2] + other.box.size_m[2]
        for other in piece.children
        if other is not child
        and footprint_polygon(other.box).intersects(footprint_polygon(child.box))
    ]
    gaps = [abs(child.box.center_m[2] - level) for level in (top_m, *under)]
    assert min(gaps) < 0.01, child.id
