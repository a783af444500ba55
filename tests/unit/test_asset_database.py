"""The mesh database: retrieval by the paper's rule, and indexes that are damaged."""

from __future__ import annotations

import ast
import json
import random
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.errors import AssetError, OutputError, SceneError
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.runtime.locations import cache_folder
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Asset, Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.library import component, database
from chord_usd.library.database import (
    TAGS,
    AssetDatabase,
    embedded_assets,
    load_database,
    read_index,
    write_index,
)
from chord_usd.library.design_tables import colour_sets, entries, sizes_m
from chord_usd.library.kit.model import Design
from chord_usd.line.graph.match import match_assets

SIDE = st.floats(0.1, 4.0).map(lambda side: round(side, 3))
SIZE = st.tuples(SIDE, SIDE, SIDE)


def bed(name: str, size_m: tuple[float, float, float]) -> Asset:
    return Asset(name, "bed", size_m, Path(f"{name}/{name}.usda"))


@given(sizes=st.lists(SIZE, min_size=1, max_size=12), wanted=SIZE, seed=st.integers(0, 99))
def test_the_nearest_asset_has_the_least_squared_difference(
    sizes: list[tuple[float, float, float]], wanted: tuple[float, float, float], seed: int
) -> None:
    assets = [bed(f"Bed_{i}", size) for i, size in enumerate(sizes)]
    decoy = Asset("Sofa", "sofa", wanted, Path("Sofa.usda"))
    found = AssetDatabase((*assets, decoy)).nearest("bed", wanted)

    def difference(size: tuple[float, float, float]) -> float:
        return (size[0] - wanted[0]) ** 2 + (size[1] - wanted[1]) ** 2

    assert found.category == "bed"
    assert difference(found.size_m) <= min(map(difference, sizes)) + 1e-9
    random.Random(seed).shuffle(assets)
    assert AssetDatabase(tuple(assets)).nearest("bed", wanted) == found


def test_ties_go_to_the_nearer_height_then_to_the_lower_id() -> None:
    low, high, twin = bed("C", (1, 2, 0.8)), bed("B", (1, 2, 1.2)), bed("A", (1, 2, 1.2))
    beds = AssetDatabase((low, high, twin))
    assert beds.nearest("bed", (1.1, 2, 0.9)) is low
    assert beds.nearest("bed", (1.1, 2, 1.1)) is twin


def test_a_category_without_asset_or_name_is_an_error() -> None:
    beds = AssetDatabase((bed("A", (1, 2, 1)),))
    assert beds.of_category("sofa") == ()
    with pytest.raises(AssetError, match="nothing of the category 'sofa'"):
        beds.nearest("sofa", (1, 1, 1))
    with pytest.raises(SceneError, match="use 'sofa'"):
        beds.nearest("sofas", (1, 1, 1))


def stored(folder: Path, assets: list[Asset]) -> list[Asset]:
    """Assets whose layers lie in folder, with an index."""
    for asset in assets:
        path = folder / asset.usd_path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("#usda 1.0\n")
    placed = [
        Asset(a.id, a.category, a.size_m, folder / a.usd_path, "CC0-1.0", "someone") for a in assets
    ]
    write_index(placed, folder)
    return placed


def test_an_index_reads_back_as_it_was_written(tmp_path: Path) -> None:
    assets = stored(tmp_path, [bed("A", (1.0, 2.0, 0.9)), bed("B", (1.5, 2.1, 1.1))])
    assert list(read_index(tmp_path)) == assets


def test_a_folder_given_replaces_what_is_embedded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = stored(tmp_path / "embedded", [bed("A", (1.0, 2.0, 0.9)), bed("B", (1.5, 2.1, 1.1))])
    monkeypatch.setattr(database, "embedded_assets", lambda texture_px: tuple(shipped))
    (mine,) = stored(tmp_path / "mine", [bed("A", (0.9, 1.9, 0.8))])
    found = load_database([tmp_path / "mine"])
    assert {asset.id: asset for asset in found.assets}["A"] == mine
    assert len(found.assets) == 2


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("size_m", [1.0, 2.0], "A: size_m is [1.0, 2.0]"),
        ("size_m", [1.0, 2.0, -1.0], "A: size_m"),
        ("size_m", [1.0, 2.0, float("nan")], "A: size_m"),
        ("category", "bedd", "A: unknown category 'bedd'"),
        ("path", "gone.usda", "A: gone.usda is missing"),
    ],
)
def test_a_damaged_entry_is_named(tmp_path: Path, key: str, value: object, said: str) -> None:
    stored(tmp_path, [bed("A", (1.0, 2.0, 0.9))])
    index = tmp_path / "index.json"
    data = json.loads(index.read_text())
    data["assets"][0][key] = value
    index.write_text(json.dumps(data))
    with pytest.raises(AssetError) as caught:
        read_index(tmp_path)
    assert said in str(caught.value)
    assert "index.json" in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "[]", '{"assets": 3}', '{"assets": [{}]}', "\udcff"])
def test_a_damaged_index_is_an_asset_error(tmp_path: Path, text: str) -> None:
    (tmp_path / "index.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    with pytest.raises(AssetError, match=r"index\.json"):
        read_index(tmp_path)


def test_a_folder_without_index_is_an_asset_error(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match="no mesh database here"):
        read_index(tmp_path)


def test_the_cache_follows_the_environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path / "own"))
    assert cache_folder() == tmp_path / "own"
    monkeypatch.delenv("CHORD_USD_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "chord-usd"


def test_what_the_user_brought_goes_before_what_is_nearer() -> None:
    shipped, mine = bed("Shipped", (1.8, 2.1, 1.0)), bed("Mine", (1.7, 2.0, 1.0))
    beds = AssetDatabase((mine, shipped), frozenset({"Mine"}))
    assert beds.nearest("bed", (1.8, 2.1, 1.0)) is mine
    assert beds.nearest("bed", (2.1, 2.4, 1.0)) is mine
    far = bed("Mine", (0.9, 1.9, 1.0))
    assert AssetDatabase((far, shipped), frozenset({"Mine"})).nearest("bed", (1.8, 2.1, 1)) is (
        shipped
    )


def shipped_bed() -> Asset:
    return next(asset for asset in database.embedded_assets() if asset.category == "bed")


def test_half_a_component_is_never_left_behind(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path))

    def interrupted(design: Design, folder: Path, maps: object = None) -> Path:
        (folder / design.id).mkdir()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(component, "write_component", interrupted)
    with pytest.raises(OutputError, match="CHORD_USD_CACHE"):
        database.draw_embedded(shipped_bed())
    assert [
        path for path in tmp_path.rglob("*") if path.name != database.embedded_folder().name
    ] == []


def test_a_cache_that_is_a_file_is_an_output_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path / "file"))
    with pytest.raises(OutputError):
        database.draw_embedded(shipped_bed())


@pytest.mark.parametrize(
    ("column", "kept"),
    [("rooms", True), ("words", True), ("wikidata", False), ("kg_per_m3", False)],
)
def test_drawn_assets_stay_where_a_fact_changes_that_they_do_not_state(
    monkeypatch: pytest.MonkeyPatch, column: str, kept: bool
) -> None:
    before = database._generator_hash()
    rows = {name: dict(row) for name, row in database.category_rows().items()}
    rows["bed"][column] += "0"
    monkeypatch.setattr(database, "category_rows", lambda: rows)
    assert (database._generator_hash() == before) is kept


LIBRARY = "chord_usd.library."


def test_whatever_draws_assets_counts_when_they_are_drawn_anew() -> None:
    root = Path(database.__file__).parent
    named = {root / name for name in database._GENERATOR}
    sources = [file for one in named for file in (one.rglob("*.py") if one.is_dir() else [one])]
    used = set()
    for file in (one for one in sources if one.suffix == ".py"):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(LIBRARY):
                below = (node.module or "").removeprefix(LIBRARY).split(".")
                names = [alias.name for alias in node.names]
                used |= {root / f"{'/'.join([*below, name])}.py" for name in ["", *names]}
                used |= {root / f"{'/'.join(below)}.py"}
    used = {file for file in used if file.is_file()}
    assert {"physical", "material", "solids"} <= {file.stem for file in used}
    assert used <= set(sources), "a change there would leave old assets in caches"


def test_retrieval_imports_no_geometry() -> None:
    code = """import sys
from chord_usd.library.database import load_database
load_database().of_category("sofa")
print(*sorted(name for name in sys.modules if name.startswith("chord_usd.library.")))"""
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    assert set(printed.stdout.decode().split()) == {
        f"chord_usd.library.{name}" for name in ("database", "design_tables")
    }


def test_a_users_asset_is_set_apart_by_its_tags_not_by_words_in_its_id(tmp_path: Path) -> None:
    size_m = (0.5, 0.5, 0.9)
    plain, swivel = (
        Asset(name, "chair", size_m, Path(f"{name}/{name}.usda"), tags=tags)
        for name, tags in (("Oak_Office_Room", ()), ("A_Castor", ("swivels",)))
    )
    stored(tmp_path, [plain])
    (tmp_path / "A_Castor").mkdir()
    (tmp_path / swivel.usd_path).write_text("#usda 1.0\n")
    write_index([replace(a, usd_path=tmp_path / a.usd_path) for a in (plain, swivel)], tmp_path)
    chairs = AssetDatabase(read_index(tmp_path))
    assert chairs.nearest("chair", size_m).id == "A_Castor"
    assert chairs.nearest("chair", size_m, at_desk=False).id == "Oak_Office_Room"


def test_tables_name_known_tags_categories_and_colours_only() -> None:
    for entry in entries().values():
        assert set(entry.tags) <= set(TAGS), entry.id
        assert entry.category in CATEGORIES, entry.id
        assert colour_sets(entry.folder)[entry.colours], entry.id


def test_sizes_of_a_cell_are_every_combination_of_each_group() -> None:
    assert list(sizes_m("0.5 0.65, 0.4, 0.8; 1:1.4:0.2, 0.5, 0.9")) == [
        (0.5, 0.4, 0.8), (0.65, 0.4, 0.8), (1.0, 0.5, 0.9), (1.2, 0.5, 0.9), (1.4, 0.5, 0.9),
    ]  # fmt: skip


def test_chairs_swivel_at_desks_only():
    chairs = load_database(texture_px=16)
    assert "Office" in chairs.nearest("chair", (0.57, 0.56, 0.95)).id
    assert "Office" not in chairs.nearest("chair", (0.57, 0.56, 0.95), at_desk=False).id


@pytest.mark.parametrize("sill_m", [0.2, 0.9])
@pytest.mark.parametrize(("beside_m", "is_bare"), [(0.0, False), (0.03, True), (0.3, True)])
def test_a_cabinet_is_built_as_it_is_judged(sill_m: float, beside_m: float, is_bare: bool) -> None:
    """With a television unless it stands before a window, by however little."""
    room = Room("room", "living", frozen_array([(0, 0), (5, 0), (5, 4), (0, 4)]))
    window = Opening("w", "window", Box((1.0, -0.12, sill_m), (1.2, 0.24, 1.2), 0.0), ("room",))
    box = Box((1.6 + 0.8 - beside_m, 0.2, 0.0), (1.6, 0.4, 0.5), 180.0)
    house = SceneGraph((room,), (window,), (Item("room/tv_cabinet_0", "tv_cabinet", box, "room"),))
    (asset,) = match_assets(house, AssetDatabase(embedded_assets())).assets()
    assert ("no_screen" in asset.tags) == is_bare
    (view,) = view_home(house).rooms
    assert bool(view.bare) == is_bare


def test_a_chair_that_came_before_a_window_is_low_enough_for_it() -> None:
    """By 8 cm; nothing noted then how high the sill is."""
    chairs = [each for each in embedded_assets() if each.category == "chair"]
    high = next(each for each in chairs if each.size_m[2] > 0.95)
    low = next(each for each in chairs
               if each.size_m[2] < 0.89 and each.size_m[1] != high.size_m[1])  # fmt: skip
    room = Room("room", "dining", frozen_array([(0, 0), (5, 0), (5, 4), (0, 4)]))
    window = Opening("w", "window", Box((2.0, -0.12, 0.9), (1.2, 0.24, 1.2), 0.0), ("room",))
    for beside_m, asset in ((-0.08, low), (0.3, high)):
        box = Box((2.6 + high.size_m[0] / 2 + beside_m, 0.3, 0.0), high.size_m, 180.0)
        house = SceneGraph((room,), (window,), (Item("c", "chair", box, "room"),))
        assert match_assets(house, AssetDatabase((high, low))).items[0].asset == asset
