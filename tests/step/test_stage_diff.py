"""What `diff` says about two stages."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Usd, UsdGeom

from chord_usd.base.errors import StageError
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.library.looks.look_library import StyleLooks
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.read.diff import diff_stages


@pytest.fixture(scope="module")
def written(staged_graph: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("before")
    return author_stage(staged_graph, folder / "before.usda", seed=3).path


@pytest.fixture
def before(written: Path, tmp_path: Path) -> Path:
    shutil.copytree(written.parent, tmp_path, dirs_exist_ok=True)
    return tmp_path / written.name


def changed(graph: SceneGraph, number: int, item: Item | None) -> SceneGraph:
    """The graph with another item in the place of one of its own, or none."""
    items = list(graph.items)
    items[number : number + 1] = [item] if item else []
    return replace(graph, items=tuple(items))


def told(before: Path, graph: SceneGraph) -> list[str]:
    after = author_stage(graph, before.with_name("after.usda"), seed=3).path
    return [
        f"{change.path.split('/')[-1]} {change.text}"
        for change in diff_stages(before, after)
        if "Furniture" in change.path
    ]


def test_the_same_house_has_not_changed(before: Path, tmp_path: Path) -> None:
    assert diff_stages(before, before) == ()
    shutil.copytree(tmp_path, tmp_path / "copy")
    assert diff_stages(before, tmp_path / "copy" / before.name) == ()


def test_a_piece_that_moves_and_turns(before: Path, staged_graph: SceneGraph) -> None:
    item = staged_graph.items[0]
    x, y, z = item.box.center_m
    moved = replace(item.box, center_m=(x, y + 0.5, z), yaw_deg=item.box.yaw_deg + 90.0)
    texts = told(before, changed(staged_graph, 0, replace(item, box=moved)))
    assert [text.split(" ", 1)[1] for text in texts] == [
        "moved 0.50 m to the north", "turned by 90.0 degrees",
    ]  # fmt: skip


def test_a_piece_that_goes_and_one_that_comes(before: Path, staged_graph: SceneGraph) -> None:
    last = max(range(len(staged_graph.items)), key=lambda n: staged_graph.items[n].category)
    texts = told(before, changed(staged_graph, last, None))
    assert sum("is gone" in text for text in texts) == 1
    same = author_stage(staged_graph, before.with_name("again.usda"), seed=3).path
    back = diff_stages(before.with_name("after.usda"), same)
    assert sum("is new" in change.text for change in back) == 1


def test_an_artist_s_choices_are_told(before: Path, tmp_path: Path) -> None:
    after = tmp_path / "after.usda"
    shutil.copy(before, after)
    stage = Usd.Stage.Open(str(after))
    stage.GetDefaultPrim().GetVariantSet("lighting").SetVariantSelection("evening")
    lamp = next(prim for prim in stage.Traverse() if prim.GetTypeName() == "RectLight")
    lamp.GetAttribute("inputs:width").Set(0.5)
    UsdGeom.Imageable(lamp).MakeInvisible()
    stage.Save()
    texts = [f"{change.path} {change.text}" for change in diff_stages(before, after)]
    assert "/House uses another lighting: day became evening" in texts
    assert "/House/Lighting/Sun is gone" in texts
    assert f"{lamp.GetPath()} visibility: nothing became invisible" in texts
    assert any("inputs:width" in text and text.endswith("0.5") for text in texts)


def test_other_looks_are_told_by_name(
    staged_graph: SceneGraph, looks_of: Callable[[int], StyleLooks], tmp_path: Path
) -> None:
    first = author_stage(staged_graph, tmp_path / "a.usda", looks=looks_of(1)).path
    second = author_stage(staged_graph, tmp_path / "b.usda", looks=looks_of(2)).path
    assert any("uses another wallMaterial" in c.text for c in diff_stages(first, second))


def test_a_file_that_is_no_stage(before: Path, tmp_path: Path) -> None:
    (tmp_path / "x.usda").write_text("no")
    with pytest.raises(StageError):
        diff_stages(before, tmp_path / "x.usda")
