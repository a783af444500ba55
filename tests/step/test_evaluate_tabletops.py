"""evaluate tabletops: right where the answer is known, and a verb that can be run."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.raster import canvas
from chord_usd.base.raster.table_top import Border
from chord_usd.base.scene.palette import Level
from chord_usd.base.scene.types import Asset, Box, Item
from chord_usd.cli import DONE, UNUSABLE, main
from chord_usd.library.asset_shapes import relief_of
from chord_usd.library.database import load_database
from chord_usd.line.graph.table_items import TopPainter
from chord_usd.line.layout.checkpoint import Checkpoint, save_checkpoint
from chord_usd.line.layout.config import PRESETS, TABLE
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.line.lists.things import THINGS
from chord_usd.workshop.evaluation import tabletop_report, tabletops
from chord_usd.workshop.evaluation.tabletop_cases import Case, procedural_cases, redrawn
from chord_usd.workshop.training.lists_network import ListNetwork
from chord_usd.workshop.training.lists_trainer import write_checkpoint

TINY = replace(
    TABLE, channels=(16, 32), attention=(False, False), feature_channels=16, default_steps=2
)
TINY_HOUSE = replace(
    PRESETS["default"], channels=(16, 32), attention=(False, False), feature_channels=16
)


@pytest.fixture(scope="module")
def model() -> LayoutModel:
    """A model that was never trained: its pictures are noise."""
    torch.manual_seed(0)
    network = LayoutNetwork(TINY).eval().requires_grad_(False)
    return LayoutModel(TorchDenoiser(Checkpoint(network, TINY, "hash", {})))


@pytest.fixture(scope="module")
def at(model: LayoutModel) -> tabletops.Workplace:
    return tabletops.Workplace(TopPainter(model.sample_batch, "hash"), load_database(), relief_of)


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    return procedural_cases(15)


def thing(name: str, x: float, y: float, size_m, yaw: float = 0.0) -> Item:
    return Item(f"{name} {x} {y}", name, Box((x, y, 0.0), size_m, yaw))


def case_of(*items: Item, borders: tuple[Border, ...] = ()) -> Case:
    """A case whose truth is these items on the largest of the first tops."""
    case = max(procedural_cases(12), key=lambda one: one.view.top.free.sum())
    view = replace(case.view, top=replace(case.view.top, borders=borders))
    return replace(case, view=view, truth=items)


def judged_of(at: tabletops.Workplace, *items: Item) -> tabletops.Judged:
    case = case_of(*items)
    return tabletops.judge_layouts(at, [case], [case.drawn])[0]


def test_the_data_itself_has_no_fault(at: tabletops.Workplace, cases: list[Case]) -> None:
    judged = tabletops.judge_layouts(at, cases, [case.drawn for case in cases])
    scores = tabletops.score_tabletops(judged, at)
    values = {name: score.value for name, score in scores.rows.items()}
    assert values["por"] == values["placed_por"] == 0.0
    assert values["supported"] == values["faces_right"] == 1.0
    assert values["off_edge"] < 0.02
    assert values["filled"] > 0.95
    assert values["items"] == pytest.approx(values["items_of_data"], rel=0.05)
    assert values["round_trip"] > 0.95
    assert values["categories_tv"] < 0.02
    assert values["counts_tv"] < 0.1
    assert values["dining_laid"] == 1.0
    assert scores.pieces == len(cases)
    assert set(scores.by_category) == {case.view.item.category for case in cases}


def test_a_bare_table_is_not_filled(at: tabletops.Workplace, cases: list[Case]) -> None:
    bare = [canvas.layout_image(case.image, (), Level.TABLE) for case in cases]
    scores = tabletops.score_tabletops(tabletops.judge_layouts(at, cases, bare), at)
    assert scores.rows["filled"].value == 0.0
    assert scores.rows["por"].count == 0, "no pair, no overlap ratio"


def test_overlap_counts_before_placing_and_not_after(at: tabletops.Workplace) -> None:
    one = judged_of(
        at,
        thing("laptop", 0.0, 0.0, (0.36, 0.31, 0.2)),
        thing("food", 0.12, 0.1, (0.2, 0.2, 0.1), 30.0),
    )
    raw = thing("laptop", 0.0, 0.0, (0.36, 0.31, 0.2)), thing("food", 0.12, 0.1, (0.2, 0.2, 0.1))
    scores = tabletops.score_tabletops([replace(one, raw=raw)], at).rows
    assert scores["por"].value == 1.0
    assert scores["placed_por"].value == 0.0
    assert scores["left_out"].value > 0.0


def test_what_lies_on_a_pad_is_no_unintended_overlap(at: tabletops.Workplace) -> None:
    one = judged_of(
        at,
        thing("big_mouse_pad", 0.0, 0.0, (0.8, 0.35, 0.004)),
        thing("laptop", 0.0, 0.0, (0.36, 0.3, 0.2)),
    )
    scores = tabletops.score_tabletops([one], at).rows
    assert scores["por"].value == 0.0
    assert scores["por_all"].value == 1.0


def test_off_the_edge_is_off_the_edge(at: tabletops.Workplace) -> None:
    one = judged_of(at, thing("laptop", 0.0, 0.0, (0.36, 0.31, 0.2)))
    half = one.case.view.item.box.size_m[0] / 2
    over = replace(one, raw=(thing("laptop", half, 0.0, (0.36, 0.31, 0.2)),))
    assert tabletops.score_tabletops([one], at).rows["off_edge"].value == 0.0
    assert tabletops.score_tabletops([over], at).rows["off_edge"].value == 1.0


@pytest.mark.parametrize(
    ("yaw", "borders", "right"),
    [
        (0.0, (Border("front", "seat", -0.2, 0.2),), True),
        (40.0, (Border("front", "seat", -0.2, 0.2),), True),
        (50.0, (Border("front", "seat", -0.2, 0.2),), False),
        (180.0, (Border("front", "seat", -0.2, 0.2),), False),
        (90.0, (Border("right", "seat", -0.2, 0.2),), True),
        (-90.0, (Border("right", "seat", -0.2, 0.2),), False),
        (180.0, (Border("back", "wall", -0.2, 0.2),), False),
        (90.0, (Border("back", "wall", -0.2, 0.2),), True),
        (180.0, (), True),
    ],
)
def test_fronts_face_seats_or_at_least_no_wall(yaw: float, borders, right: bool) -> None:
    item = thing("laptop", 0.0, 0.0, (0.36, 0.31, 0.2), yaw)
    assert tabletops.faces_somebody(item, case_of(item, borders=borders)) is right


def test_support_is_contact_below_the_middle() -> None:
    relief = case_of().view.relief
    half, top_m = relief.size_m[0] / 2, relief.level_m

    def stands(x: float, z: float, siblings: tuple[Item, ...] = ()) -> bool:
        child = Item("a", "food", Box((x, 0.0, z), (0.2, 0.2, 0.1), 0.0))
        return tabletops.is_supported(child, (child, *siblings), relief, relief_of)

    assert stands(0.0, top_m)
    assert not stands(0.0, top_m + 0.05), "floats"
    assert not stands(0.0, top_m - 0.05), "sunk in"
    assert stands(half - 0.05, top_m)
    assert not stands(half + 0.05, top_m), "tips over the edge"
    pad = load_database().nearest("big_mouse_pad", (0.8, 0.35, 0.01))
    under = Item("p", "big_mouse_pad", Box((0.0, 0.0, top_m + 0.03), pad.size_m, 0.0), asset=pad)
    assert stands(0.0, top_m + 0.03 + pad.size_m[2], (under,))
    assert not stands(half, top_m + 0.03 + pad.size_m[2], (under,))


def test_the_reader_is_scored_against_what_was_drawn(cases: list[Case]) -> None:
    scores = tabletops.score_reader(cases, [case.drawn for case in cases])
    assert scores.recall >= 0.97
    assert scores.recall_painted >= 0.97
    assert scores.precision >= 0.97
    assert scores.edge_px < 0.5
    bare = [canvas.layout_image(case.image, (), Level.TABLE) for case in cases]
    nothing = tabletops.score_reader(cases, bare)
    assert (nothing.recall, nothing.precision) == (0.0, 0.0)


def test_redrawing_with_hardly_any_noise_shows_no_more_than_the_network(
    model: LayoutModel, cases: list[Case]
) -> None:
    layouts = redrawn(model, cases[:2], 1.0)
    for case, layout in zip(cases, layouts, strict=False):
        outside = case.view.top.free.size and (case.image.rgb == 255).all(axis=2)
        assert np.array_equal(layout.rgb[outside], case.image.rgb[outside])


def test_the_sheet_has_a_row_per_part(at: tabletops.Workplace, cases: list[Case]) -> None:
    import cv2

    judged = tabletops.judge(at, cases[:2], [case.truth or () for case in cases[:2]])
    png = tabletop_report.draw_sheet([judged, judged[:1]])
    height, width, _ = cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR).shape
    assert width / height == pytest.approx(tabletop_report.COLUMNS / 2)


def test_the_verb_writes_table_figures_and_sheet(tmp_path: Path, capsys) -> None:
    words = ["evaluate", "tabletops", "--n", 3, "--houses", 0, "-o", tmp_path / "scores.md"]
    words += ["--no-list", "--steps", 4, "--json", "--progress", "none"]
    assert main([*map(str, words)]) == DONE
    told = json.loads(capsys.readouterr().out)
    assert told["columns"]["data"]["rows"]["por"]["value"] == 0.0
    assert told["batch"] == 3
    assert told["batch_cpu_seconds"] > 0.0
    assert json.loads((tmp_path / "scores.json").read_text())["columns"] == told["columns"]
    assert "supported" in (tmp_path / "scores.md").read_text()
    assert (tmp_path / "scores.png").stat().st_size > 1000


def test_lists_are_scored_on_tops_and_in_houses(tmp_path: Path, capsys) -> None:
    torch.manual_seed(0)
    write_checkpoint(tmp_path, ListNetwork(THINGS, channels=16, layers=1, heads=2), THINGS, {})
    words = ["evaluate", "tabletops", "--lists", tmp_path, "--n", 4, "--houses", 1, "--drafts", 2]
    assert main([*map(str, words), "--json", "--progress", "none"]) == DONE
    told = json.loads(capsys.readouterr().out)
    assert told["how"] == "the best of 2 lists of each top"
    assert told["columns"]["houses"]["pieces"] > 3
    assert not told["reader"], "no raster, no reader"


def test_a_model_of_houses_is_refused(tmp_path: Path, capsys) -> None:
    save_checkpoint(tmp_path / "house", LayoutNetwork(TINY_HOUSE), {})
    words = ["evaluate", "tabletops", "--checkpoint", tmp_path / "house", "--progress", "none"]
    assert main([*map(str, words)]) == UNUSABLE
    assert "is a model of houses" in capsys.readouterr().err


def test_meshes_of_items_exist_for_every_category(at: tabletops.Workplace) -> None:
    from chord_usd.base.scene.palette import TABLE_CATEGORIES

    for row in TABLE_CATEGORIES:
        size_m = (row.length_m[0], row.width_m[0], row.height_m[0])
        assert isinstance(at.database.nearest(row.name, size_m), Asset)
