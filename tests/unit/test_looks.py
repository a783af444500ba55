"""The material library: what is shipped, and what is drawn for a room."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from chord_usd.errors import AssetError
from chord_usd.scene.looks import Look, load_looks, sample_look
from chord_usd.scene.types import ROOM_KINDS, RoomKind

SHIPPED = load_looks()
KINDS = [kind for kind in ROOM_KINDS if kind != "unknown"]


def look(name: str, surface: str, kinds: tuple[RoomKind, ...]) -> Look:
    return Look(name, name, surface, kinds, (1.0, 1.0), Path(name), "", "")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("surface", ["floor", "wall"])
def test_every_kind_of_room_has_a_choice_of_looks(kind: RoomKind, surface: str) -> None:
    fitting = [x for x in SHIPPED if x.surface in (surface, "both") and kind in x.kinds]
    assert len(fitting) >= 2
    for seed in range(20):
        chosen = sample_look(SHIPPED, surface, kind, np.random.default_rng(seed))  # type: ignore[arg-type]
        assert chosen in fitting


def test_the_same_seed_gives_the_same_look_and_all_looks_get_their_turn() -> None:
    def chosen(seed: int) -> str:
        return sample_look(SHIPPED, "floor", "bedroom", np.random.default_rng(seed)).name

    assert [chosen(seed) for seed in range(30)] == [chosen(seed) for seed in range(30)]
    counts = Counter(chosen(seed) for seed in range(700))
    fitting = [x for x in SHIPPED if x.surface != "wall" and "bedroom" in x.kinds]
    assert len(counts) == len(fitting)
    assert min(counts.values()) > 700 / len(fitting) / 2


def test_kinds_that_no_look_suits_are_served_as_unknown() -> None:
    plain, tile = look("Plain", "wall", ("unknown",)), look("Tile", "both", ("bathroom",))
    rng = np.random.default_rng(0)
    assert sample_look([plain, tile], "wall", "store", rng) is plain
    assert sample_look([tile], "wall", "store", rng) is tile
    with pytest.raises(AssetError, match="no look for a floor"):
        sample_look([plain], "floor", "store", rng)


def test_shipped_looks_say_whose_they_are() -> None:
    assert len(SHIPPED) >= 24
    for shipped in SHIPPED:
        assert shipped.licence == "CC0-1.0"
        assert shipped.author
        assert shipped.usd_path.parent.name == shipped.name


def test_a_folder_without_looks_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match="no looks here"):
        load_looks(tmp_path)


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
    assert load_looks(tmp_path)[0].name == "Oak"
    (folder / "look.json").write_text(json.dumps({**data, key: value}))
    with pytest.raises(AssetError) as caught:
        load_looks(tmp_path)
    assert said in str(caught.value)
    assert "look.json" in str(caught.value)
