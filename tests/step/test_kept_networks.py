"""Optimised graphs in the cache: the same network, made again where the file is damaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.runtime.locations import CACHE_VARIABLE, checkpoint_folder
from chord_usd.base.runtime.networks import (
    GRAPH_FILE,
    STORED_SUFFIX,
    WEIGHTS_FILE,
    load_graph,
    load_network,
    read_weights,
)


def test_kept_networks_are_the_same_networks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    folder = checkpoint_folder("detector_items")
    rgb = np.random.default_rng(0).integers(0, 255, (1, 256, 256, 3)).astype(np.uint8)
    weights = read_weights(folder / WEIGHTS_FILE, "")
    named = {name + STORED_SUFFIX: value for name, value in weights.items()}
    (expected,) = load_graph(folder / GRAPH_FILE, named, "").run({"rgb": rgb})
    for _ in range(2):
        assert np.array_equal(load_network(folder, "").run({"rgb": rgb})[0], expected)
    (kept,) = (tmp_path / "networks").iterdir()
    whole = kept.read_bytes()
    kept.write_bytes(whole[: len(whole) // 2])
    assert np.array_equal(load_network(folder, "").run({"rgb": rgb})[0], expected)
    assert kept.stat().st_size == len(whole)


def test_a_cache_that_cannot_be_written_is_done_without(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "file"))
    assert load_network(checkpoint_folder("detector_items"), "")
