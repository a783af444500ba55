"""The program from Python: what the documents show runs, and says what the commands say."""

from __future__ import annotations

import gc
import io
import re
import shutil
from functools import partialmethod
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import Image

import chord_usd
from chord_usd.base.runtime.stages import files_of
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import main
from chord_usd.line import pipeline
from chord_usd.line.image import preview
from chord_usd.line.stage.author.names import name_rooms

ROOT = Path(__file__).parents[2]
SIZE_PX = (64, 36)


@pytest.fixture
def quick(staged_house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A house that is there already in place of the minute that generating takes, tiny pictures."""

    def generate(plans: list[Path], target: Path, *others: object) -> SimpleNamespace:
        assert all(plan.is_file() for plan in plans)
        shutil.copytree(staged_house.parent, target.parent, dirs_exist_ok=True)
        return SimpleNamespace(warnings=())

    monkeypatch.setattr(pipeline, "generate", generate)
    tiny = partialmethod(chord_usd.House.render, size=SIZE_PX, samples=1, device="cpu")
    monkeypatch.setattr(chord_usd.House, "render", tiny)


def code_in(document: str) -> str:
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / document).read_text(), re.DOTALL)
    return str(code)


@pytest.mark.acceptance
def test_what_the_documents_show_runs(
    quick: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    staged_graph: SceneGraph,
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)
    exec(code_in("README.md"), {})
    assert len(capsys.readouterr().out.splitlines()) == len(staged_graph.rooms)
    assert Image.open("out/living.png").size == SIZE_PX
    exec(code_in("docs/python.md"), {})
    assert Path("out/house.dxf").stat().st_size > 0
    copied = Path("out/saved/house.usda")
    assert copied.read_bytes() == Path("out/house.usda").read_bytes()
    assert not files_of(copied.absolute()).missing


def test_rooms_are_those_of_the_scene(staged_house: Path, staged_graph: SceneGraph) -> None:
    house = chord_usd.open(staged_house)
    named = name_rooms(staged_graph)
    assert [room.id for room in house.rooms] == [one.name for one in named]
    for room, one in zip(house.rooms, named, strict=True):
        assert room.kind == one.room.kind
        assert room.area_m2 == pytest.approx(room_polygon(one.room).area, abs=0.01)
        assert [piece.id for piece in room.pieces] == [item.name for item in one.items]
        for piece, item in zip(room.pieces, one.items, strict=True):
            assert piece.category == item.item.category
            assert piece.center_m[:2] == pytest.approx(item.item.box.center_m[:2], abs=0.01)
            assert [on.category for on in piece.carries] == [c.category for c in item.item.children]


def test_a_stage_is_seen_with_its_things_where_they_stand(
    staged_house: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By a notebook and by describe: what is on a table is drawn within it."""
    shown: list[SceneGraph] = []
    drawn = preview.preview_rgb
    monkeypatch.setattr(
        preview, "preview_rgb", lambda graph, *_: shown.append(graph) or drawn(graph)
    )
    png = tmp_path / "above.png"
    assert main(["describe", str(staged_house), "--preview", str(png), "--progress", "none"]) == 0
    own = chord_usd.open(staged_house)._repr_png_()
    assert np.array_equal(Image.open(png), Image.open(io.BytesIO(own)))
    for graph in shown:
        children = [(item, child) for item in graph.items for child in item.children]
        assert children
        for item, child in children:
            assert np.abs(child.box.center_m[:2]).max() < max(item.box.size_m[:2])


def test_a_house_without_a_path_goes_with_its_last_user(quick: None) -> None:
    house = chord_usd.generate(ROOT / "examples/two_bedrooms.png")
    path = house.path
    assert house.rooms
    del house
    gc.collect()
    assert not path.parent.exists()


def test_what_cannot_be_used_is_an_error_of_the_programs_own(
    staged_house: Path, tmp_path: Path
) -> None:
    plan = ROOT / "examples/two_bedrooms.png"
    house = chord_usd.open(staged_house)
    before = sorted(staged_house.parent.rglob("*"))
    for wrong in (
        lambda: chord_usd.open(tmp_path / "none.usda"),
        lambda: chord_usd.generate(tmp_path / "none.png"),
        lambda: chord_usd.generate(plan, seed=-1),
        lambda: chord_usd.generate(plan, seed="1"),  # type: ignore[arg-type]
        lambda: chord_usd.generate(plan, m_per_px=float("nan")),
        lambda: chord_usd.generate(plan, style="baroque"),
        lambda: chord_usd.generate(plan, sky="purple"),
        lambda: chord_usd.generate(plan, device="tpu"),
        lambda: chord_usd.generate(plan, plan),
        lambda: house.render("spaceship"),
        lambda: house.render(quality="best"),  # type: ignore[arg-type]
        lambda: house.regenerate("every room"),
        lambda: house.regenerate("bedroom 1", wish="spaceship"),
        lambda: house.export("obj", tmp_path / "house.obj"),  # type: ignore[arg-type]
        lambda: house.export("web", staged_house),
        lambda: house.save(staged_house.parent),
    ):
        with pytest.raises(chord_usd.ChordError):
            wrong()
    assert sorted(staged_house.parent.rglob("*")) == before
    assert list(tmp_path.iterdir()) == []


def test_names_of_the_package_are_found_when_asked_for() -> None:
    assert {"House", "generate", "open", "ChordError"} <= set(dir(chord_usd))
    with pytest.raises(AttributeError, match="no attribute 'furnish'"):
        chord_usd.furnish  # noqa: B018
