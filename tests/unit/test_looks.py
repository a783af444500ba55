"""Families of looks, what styles draw of them, and looks as files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.errors import AssetError, ChordError
from chord_usd.base.scene.look_families import FAMILY_FILE, family_named, load_families
from chord_usd.base.scene.looks import look_of
from chord_usd.base.scene.style_finishes import kind_of, shows, suitability
from chord_usd.base.scene.style_looks import ACCENTS, HOME_WOOD, PAINTS
from chord_usd.base.scene.style_rooms import Part, looks_for
from chord_usd.base.scene.styles import MIXED, STYLES, HomeStyle, style_named
from chord_usd.base.scene.types import ROOM_KINDS, Room, RoomKind

every_style = pytest.mark.parametrize("style", STYLES.values(), ids=lambda style: style.name)
PARTS: tuple[Part, ...] = ("floor", "wall")


def room(kind: RoomKind, number: int = 0) -> Room:
    return Room(f"{kind}{number}", kind, np.zeros((4, 2)))


# --- styles ------------------------------------------------------------------------------------


@every_style
@pytest.mark.parametrize("part", PARTS)
def test_every_kind_of_room_has_three_looks_that_can_be_drawn(style: HomeStyle, part: Part) -> None:
    for seed in range(12):
        for kind in ROOM_KINDS:
            wanted = looks_for(style, seed, part, room(kind), 3)
            assert len(wanted) == 3
            for look in wanted:
                family = family_named(look.family)
                settings = family.settings(look.settings)
                assert family.surface in (part, "both")
                assert not {HOME_WOOD, *ACCENTS} & set(map(str, settings.values()))


@every_style
def test_rooms_of_a_home_wear_one_wood_and_agree(style: HomeStyle) -> None:
    for seed in range(20):
        home = style.agreed(seed)
        inside = [kind for kind in ROOM_KINDS if kind != "balcony"]
        worn = [looks_for(style, seed, "floor", room(kind), 1)[0] for kind in inside]
        assert len({look.settings["wood"] for look in worn if "wood" in look.settings}) <= 1
        assert home.wood in style.woods
        assert home == style.agreed(seed)


@every_style
def test_a_home_has_few_different_walls(style: HomeStyle) -> None:
    for seed in range(10):
        walls = {
            str(looks_for(style, seed, "wall", room("bedroom", number), 1)[0])
            for number in range(30)
        }
        assert 1 < len(walls) <= 3


def test_seeds_give_different_homes() -> None:
    for style in STYLES.values():
        floors = {str(looks_for(style, seed, "floor", room("living"), 1)[0]) for seed in range(30)}
        assert len(floors) > 25


def test_mixed_takes_every_style_in_turn_and_a_seed_always_the_same() -> None:
    taken = [style_named(MIXED, seed).name for seed in range(100)]
    assert taken == [style_named(MIXED, seed).name for seed in range(100)]
    assert set(taken) == set(STYLES)
    with pytest.raises(ChordError, match=r"modern, .*japanese, mixed.*style=japanese"):
        style_named("japanes", 0)


@every_style
def test_every_accent_has_its_paint(style: HomeStyle) -> None:
    assert set(style.accents) <= set(PAINTS)


def test_finishes_are_known_by_their_names() -> None:
    kinds = {name: kind_of(name) for name in ("pale_oak", "rust_cloth", "black_metal", "marble")}
    assert [*kinds.values()] == ["wood", "textile", "metal", "stone"]
    assert shows("rust_cloth", "rust")
    assert not shows("grey_cloth", "rust")


@every_style
def test_colourways_of_the_home_s_own_wood_suit_it_best(style: HomeStyle) -> None:
    home = style.agreed(1)
    woods = ["oak", "walnut", "pale_oak", "cherry", "birch", "dark_walnut", "black_stain"]
    suits = {wood: suitability([wood, "steel"], style, home) for wood in woods}
    assert max(suits, key=lambda wood: suits[wood]) == home.wood
    accented = suitability([f"{home.accent}_cloth"], style, home, "cushion")
    assert accented > suitability([home.textile], style, home, "cushion")


# --- families ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"width_m": 3.0}, "width_m of planks is '3.0'; expected 0.07 to 0.32"),
        ({"width_m": "wide"}, "expected 0.07 to 0.32"),
        ({"width_m": float("nan")}, "expected 0.07 to 0.32"),
        ({"wood": "plastic"}, "wood of planks is 'plastic'; expected one of white_oak"),
        ({"widht_m": 0.2}, "planks has no parameter 'widht_m'"),
    ],
)
def test_broken_parameters_are_told(given: Mapping[str, object], said: str) -> None:
    with pytest.raises(AssetError) as caught:
        family_named("planks").settings(given)
    assert said in str(caught.value)


def test_an_unknown_family_is_told_with_the_nearest() -> None:
    with pytest.raises(AssetError, match=r"'plank'.*planks"):
        family_named("plank")


def test_a_user_s_family_narrows_a_drawing(tmp_path: Path) -> None:
    folder = tmp_path / "narrow"
    folder.mkdir()
    data = {
        "name": "narrow", "label": "Narrow planks", "surface": "floor", "drawing": "planks",
        "parameters": {"width_m": {"range": [0.08, 0.1], "default": 0.09, "about": "width, m"}},
    }  # fmt: skip
    (folder / FAMILY_FILE).write_text(json.dumps(data))
    assert load_families(tmp_path)["narrow"].settings({}) == {"width_m": 0.09}
    data["parameters"]["width_m"]["default"] = 0.2  # type: ignore[index]
    other = tmp_path / "other" / "narrow"
    other.mkdir(parents=True)
    (other / FAMILY_FILE).write_text(json.dumps(data))
    with pytest.raises(AssetError, match=r"default of width_m is 0\.2"):
        load_families(tmp_path / "other")


# --- looks as files ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("surface", "ceiling", "'ceiling'"),
        ("kinds", ["bedroom", "garage"], "'garage'"),
        ("tile_m", [1.0], "unpack"),
        ("tile_m", [0.0, 1.0], "tile_m"),
        ("tile_m", [float("nan"), 1.0], "tile_m"),
        ("name", "Elsewhere", "Elsewhere.usda is missing"),
    ],
)
def test_a_damaged_look_is_named(tmp_path: Path, key: str, value: object, said: str) -> None:
    folder = tmp_path / "Oak"
    folder.mkdir()
    (folder / "Oak.usda").write_text("#usda 1.0\n")
    data = {
        "name": "Oak", "label": "Oak", "surface": "floor", "kinds": ["bedroom"],
        "tile_m": [1.0, 1.0], "licence": "CC0-1.0", "author": "someone",
    }  # fmt: skip
    (folder / "look.json").write_text(json.dumps(data))
    assert look_of(folder).name == "Oak"
    (folder / "look.json").write_text(json.dumps({**data, key: value}))
    with pytest.raises(AssetError) as caught:
        look_of(folder)
    assert said in str(caught.value)
    assert "look.json" in str(caught.value)
