"""FID by Inception: for those who have its weights."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from chord_usd.base.errors import CheckpointError
from chord_usd.cli import main
from chord_usd.workshop.evaluation.encoders import InceptionEncoder

COMMAND = ["evaluate", "layouts", "--furnisher", "--n", "10"]


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a network that was never trained."""
    from torchvision.models import inception_v3

    torch.manual_seed(0)
    path = tmp_path_factory.mktemp("inception") / "inception.pth"
    torch.save(inception_v3(weights=None, init_weights=False).state_dict(), path)
    return path


def test_features_are_of_the_picture_and_of_any_size(weights: Path) -> None:
    encoder = InceptionEncoder(weights)
    small, large = np.zeros((20, 30, 3), np.uint8), np.full((300, 280, 3), 200, np.uint8)
    found = encoder.features([small, large, small])
    assert found.shape == (3, 2048)
    found /= found.max()
    assert np.allclose(found[0], found[2], atol=1e-3)
    assert not np.allclose(found[0], found[1], atol=1e-2)
    assert encoder.features([]).shape == (0, 2048)


@pytest.mark.acceptance
def test_figures_carry_its_name(weights: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*COMMAND, "--inception", str(weights), "--json"]) == 0
    house = json.loads(capsys.readouterr().out)["realism"]["house"]
    assert house["encoder"] == "Inception"
    assert house["count"] == 10


@pytest.mark.parametrize("held", [b"", b"no weights", None])
def test_another_file_is_refused(
    held: bytes | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "other.pth"
    if held is None:
        torch.save({"fc.weight": torch.zeros(2)}, path)
    else:
        path.write_bytes(held)
    with pytest.raises(CheckpointError, match="no weights of Inception"):
        InceptionEncoder(path)
    assert main([*COMMAND, "--inception", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_it_is_not_asked_for_where_nothing_is_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for more in (["--no-fid"], []):
        assert main([*COMMAND, "--inception", str(tmp_path / "none"), *more]) == 2
        assert capsys.readouterr().err.count("\n") == 1
