"""Cloths that are stored: sound, small, with a weave of true size, and always the same."""

from __future__ import annotations

import hashlib

import numpy as np
import pytest
import trimesh

from chord_usd.base.errors import AssetError
from chord_usd.library.cloth.stored import FOLDER, names, save, stored
from tests.every import for_every

SHEETS = ("coat_", "curtain_")
"""Coats are open at collar and hem."""
MOST_TRIANGLES = 6000
MOST_BYTES = 1_500_000

every_cloth = for_every("name", names())


@every_cloth
def test_is_closed_or_a_sheet(name: str) -> None:
    cloth = stored(name).solid
    mesh = trimesh.Trimesh(cloth.points_m, cloth.faces, process=False)
    assert mesh.is_winding_consistent
    assert len(cloth.faces) <= MOST_TRIANGLES
    if not name.startswith(SHEETS):
        assert mesh.is_watertight
        assert mesh.volume > 0.0


@every_cloth
def test_the_weave_has_its_true_size(name: str) -> None:
    """An edge is as long on the cloth as in space: cloth hardly stretches."""
    cloth = stored(name)
    a, b = cloth.solid.faces[:, 0], cloth.solid.faces[:, 1]
    flat = np.linalg.norm(cloth.uvs_m[a] - cloth.uvs_m[b], axis=1)
    real = np.linalg.norm(cloth.solid.points_m[a] - cloth.solid.points_m[b], axis=1)
    far = flat > 0.01
    assert 0.8 <= np.median(real[far] / flat[far]) <= 1.2


@every_cloth
def test_has_the_size_of_what_it_is(name: str) -> None:
    size = np.ptp(stored(name).solid.bounds_m(), axis=0)
    assert np.all(size > 0.05)
    assert np.all(size < 2.6)


def test_all_of_them_are_small_and_stay_the_same_when_stored_again() -> None:
    assert sum(file.stat().st_size for file in FOLDER.glob("*.npz")) < MOST_BYTES
    name = names()[0]
    kept = (FOLDER / f"{name}.npz").read_bytes()
    first = hashlib.sha256(stored(name).solid.points_m.tobytes()).hexdigest()
    stored.cache_clear()
    assert hashlib.sha256(stored(name).solid.points_m.tobytes()).hexdigest() == first
    assert (FOLDER / f"{name}.npz").read_bytes() == kept


def test_a_stored_cloth_reads_back(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("chord_usd.library.cloth.stored.FOLDER", tmp_path)
    points = np.random.default_rng(0).uniform(-1.0, 2.0, (50, 3))
    faces = np.arange(48).reshape(16, 3)[:, ::-1]
    first = save("made_up", points, faces, points[:, :2]).read_bytes()
    found = stored("made_up")
    assert np.abs(found.solid.points_m - points).max() < 1e-4
    assert np.array_equal(found.solid.faces, faces)
    assert save("made_up", points, faces, points[:, :2]).read_bytes() == first
    stored.cache_clear()


def test_a_name_that_is_none_is_refused() -> None:
    with pytest.raises(AssetError, match="no stored cloth 'flag'"):
        stored("flag")
