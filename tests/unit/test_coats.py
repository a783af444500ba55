"""Colours and materials as people say them, and the looks that they ask for."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.colour_space import ALIKE, colour_distance, lightness
from chord_usd.base.scene.intents import Coat
from chord_usd.base.scene.look_families import load_families
from chord_usd.library.looks.look_words import look_wanted
from chord_usd.line.lists.coat_words import coat

RGB = st.tuples(*[st.integers(0, 255)] * 3)


@pytest.mark.parametrize(
    ("said", "material", "near"),
    [
        ("white", "", (240, 238, 233)),
        ("sage green", "", (148, 162, 136)),
        ("dark green leather", "leather", (58, 78, 55)),
        ("tan leather", "leather", (186, 148, 108)),
        ("dark oak hardwood", "oak", (90, 67, 46)),
        ("light grey tiles", "tiles", (196, 197, 198)),
        ("velvet", "velvet", None),
    ],
)
def test_a_coat_is_a_colour_and_a_material(
    said: str, material: str, near: tuple[int, int, int] | None
) -> None:
    found = coat(said.split())
    assert found
    assert (found.name, found.material) == (said, material)
    assert (found.rgb is None) == (near is None)
    if near and found.rgb:
        assert colour_distance(found.rgb, near) < 0.05


@pytest.mark.parametrize("said", ["", "sofa", "green sofa", "leather green", "dark", "a white"])
def test_other_words_are_no_coat(said: str) -> None:
    assert coat(said.split()) is None


@given(one=RGB, other=RGB)
def test_a_distance_of_colours_is_symmetric_and_nothing_for_the_same(
    one: tuple[int, int, int], other: tuple[int, int, int]
) -> None:
    assert colour_distance(one, other) == pytest.approx(colour_distance(other, one))
    assert colour_distance(one, one) == 0
    assert colour_distance(one, other) >= abs(lightness(one) - lightness(other)) - 1e-9


@pytest.mark.parametrize(
    ("said", "part", "kind", "family", "settings"),
    [
        ("sage", "wall", "living", "plaster", {"colour": "#94a288"}),
        ("brick", "wall", "kitchen", "brick", {}),
        ("white tiles", "wall", "bathroom", "glazed", {"colour": "#f0eee9"}),
        ("hardwood", "floor", "living", "planks", {}),
        ("walnut", "floor", "living", "planks", {"wood": "walnut"}),
        ("light oak", "floor", "bedroom", "planks", {"wood": "pale_oak"}),
        ("dark oak hardwood", "floor", "living", "planks", {"wood": "smoked_oak"}),
        ("black marble", "floor", "bathroom", "marble", {"kind": "nero"}),
        ("blue", "floor", "bedroom", "carpet", {"colour": "#54749e"}),
        ("blue", "floor", "bathroom", "stone_tile", {"colour": "#54749e"}),
    ],
)
def test_a_coat_asks_for_a_look_that_can_be_drawn(
    said: str, part: str, kind: str, family: str, settings: dict[str, str]
) -> None:
    found = look_wanted(coat(said.split()) or Coat(""), part, kind)  # type: ignore[arg-type]
    assert found
    assert (found.family, dict(found.settings)) == (family, settings)
    load_families()[family].settings(found.settings)


@pytest.mark.parametrize(
    ("said", "part"),
    [("velvet", "wall"), ("carpet", "wall"), ("wallpaper", "floor"), ("darker", "wall")],
)
def test_what_no_surface_is_made_of_asks_for_none(said: str, part: str) -> None:
    own = coat([said]) or Coat(said, None, said)
    assert look_wanted(own, part, "living") is None  # type: ignore[arg-type]


def test_colours_of_one_name_are_alike_and_others_are_not() -> None:
    rgb = {name: found.rgb for name in ("navy", "navy blue", "blue", "red", "green", "yellow")
           if (found := coat(name.split())) and found.rgb}  # fmt: skip
    assert colour_distance(rgb["navy"], rgb["navy blue"]) < ALIKE
    assert all(
        colour_distance(rgb["red"], rgb[other]) > ALIKE for other in ("blue", "green", "yellow")
    )
