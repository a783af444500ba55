"""Open boards of shelves, as their meshes have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chord_usd.library.asset_shapes import boards_of, kept, triangles_m
from chord_usd.library.database import load_database

DATABASE = load_database()
FORMS = {asset.id.rsplit("_", 1)[0]: asset for asset in DATABASE.of_category("wall_shelf")}


@pytest.mark.parametrize("form", sorted(FORMS))
def test_every_shelf_has_a_board_inside_it(form: str) -> None:
    asset = FORMS[form]
    DATABASE.prepare(asset)
    boards = boards_of(asset)
    length, depth, height = asset.size_m
    assert len(boards) >= 1
    assert (boards[:, 3:] > boards[:, :3]).all()
    assert (np.abs(boards[:, [0, 3]]) <= length / 2 + 1e-6).all()
    assert (np.abs(boards[:, [1, 4]]) <= depth / 2 + 1e-6).all()
    assert ((boards[:, 2] > 0.0) & (boards[:, 2] <= height + 1e-6)).all()


@pytest.mark.parametrize("form", ["Bookcase", "Low_Bookcase", "Bedside_Open", "Wall_Cabinet_Open"])
def test_a_board_begins_where_its_edge_is(form: str) -> None:
    """Not where handles of doors below reach to, or books would hang over it."""
    asset = next((one for one in DATABASE.assets if one.id.startswith(form + "_")), None)
    assert asset is not None
    DATABASE.prepare(asset)
    seen, _ = triangles_m(asset.usd_path)
    for left, front, level, right, back, _ in boards_of(asset):
        flat = seen[np.abs(seen[:, :, 2] - level).max(axis=1) < 1e-4]
        middle = (left + right) / 2
        below = (flat[:, :, 0].min(axis=1) <= middle) & (flat[:, :, 0].max(axis=1) >= middle)
        assert front > flat[below][:, :, 1].min() - 1e-4
        assert back - front >= 0.14


def test_what_was_measured_is_kept_until_its_module_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path))
    asset, source = tmp_path / "assets-0/Thing/Thing.usda", tmp_path / "module.py"
    source.write_text("one")
    asked: list[float] = []

    def measure() -> dict[str, np.ndarray]:
        asked.append(1.0)
        return {"a": np.array([len(asked)], np.float64)}

    first = kept(asset, "a", source, measure)
    assert kept(asset, "a", source, measure)["a"] == first["a"]
    assert len(asked) == 1
    next(tmp_path.rglob("Thing.safetensors")).write_bytes(b"half a fi")
    assert len(kept(asset, "a", source, measure)["a"]) == 1
    other = tmp_path / "other.py"
    other.write_text("two")
    assert kept(asset, "a", other, measure)["a"] == len(asked)
