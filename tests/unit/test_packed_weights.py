"""Weights in eight bits, and back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file, save_file

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.networks import WEIGHTS_FILE, packed, read_weights, unpacked
from chord_usd.workshop.training.packed_file import write_eight_bits

SHIPPED = Path(__file__).parents[2] / "checkpoints"


@pytest.mark.parametrize("kind", [np.float16, np.float32])
@pytest.mark.parametrize("shape", [(64, 32), (16, 8, 3, 3), (2000,), (3, 5)])
def test_weights_come_back_within_half_a_step(kind: type, shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    values = rng.normal(size=shape) * rng.uniform(1e-3, 2.0, (shape[0], *[1] * (len(shape) - 1)))
    values = values.astype(kind)
    values[0] = 0.0
    (back,) = unpacked(packed({"weight": values})).values()
    assert back.dtype == kind
    if len(shape) < 2 or values.size < 1024:
        assert np.array_equal(back, values)
        return
    rows, found = (one.astype(np.float64).reshape(shape[0], -1) for one in (values, back))
    most = np.abs(rows).max(axis=1)
    assert (np.abs(rows - found).max(axis=1) <= most * (0.5 / 127 + 1e-3)).all()


def test_a_checkpoint_in_eight_bits_is_half_as_large_and_read_as_before(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    before = {"layer.weight": rng.normal(size=(256, 512)).astype(np.float16),
              "layer.bias": rng.normal(size=256).astype(np.float16)}  # fmt: skip
    path = tmp_path / WEIGHTS_FILE
    save_file(before, path)
    size = path.stat().st_size
    write_eight_bits(tmp_path)
    assert path.stat().st_size < 0.51 * size
    assert load_file(path)["layer.weight"].dtype == np.int8
    after = read_weights(path, "")
    assert {name: one.dtype for name, one in after.items()} == dict.fromkeys(before, np.float16)
    np.testing.assert_allclose(after["layer.weight"], before["layer.weight"], atol=0.02)
    path.write_bytes(path.read_bytes()[:-1] + b"x")
    with pytest.raises(CheckpointError, match="damaged"):
        read_weights(path, "")


def test_all_weights_that_ship_take_less_than_150_mb() -> None:
    files = [file for file in SHIPPED.rglob("*") if file.is_file()]
    assert sum(file.stat().st_size for file in files) < 150e6
    assert max(file.stat().st_size for file in files) < 60e6
    folders = [folder for folder in SHIPPED.iterdir() if folder.is_dir()]
    assert all((folder / "SHA256SUMS").is_file() for folder in folders)
