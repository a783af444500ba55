"""Sample sheets: what the model draws for held-out plans or tables, to be looked at."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
import torch

from chord_usd.base.scene.types import ByteArray
from chord_usd.line.layout.checkpoint import Checkpoint
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.workshop.training.stream import Drawn

SHEET_COLUMNS = 4
ENLARGE = 2
MOST_STEPS = 20


def draw_sheet(
    network: LayoutNetwork, path: Path, device: torch.device, examples: Sequence[Drawn]
) -> None:
    """Writes a PNG: a column per held-out example; above what the data holds, then two samples."""
    model = LayoutModel(TorchDenoiser(Checkpoint(network, network.config), str(device)))
    steps = min(model.config.default_steps, MOST_STEPS)
    rows = [
        [model.traits.paint(example.image, example.labels, example.front) for example in examples]
    ]
    for seed in range(2):
        rows.append(_sampled(model, examples, seed, steps))
    sheet = np.concatenate(
        [np.concatenate([_enlarged(rgb) for rgb in row], axis=1) for row in rows]
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), cv2.cvtColor(sheet, cv2.COLOR_RGB2BGR))


def _sampled(
    model: LayoutModel, examples: Sequence[Drawn], seed: int, steps: int
) -> list[ByteArray]:
    images, seeds = [example.image for example in examples], [seed] * len(examples)
    words = [example.words for example in examples if example.words is not None]
    if not words:
        # The first row of samples has drafts, where the network knows them.
        drafts = [example.draft for example in examples] if seed == 0 else ()
        layouts = model.sample_batch(images, seeds=seeds, steps=steps, drafts=drafts)
        return [image.rgb for image in layouts]
    maps = model.sample_labels(images, np.stack(words), seeds=seeds, steps=steps)
    return [
        model.traits.paint(image, labels, np.zeros(labels.shape, np.bool_))
        for image, labels in zip(images, maps, strict=True)
    ]


def _enlarged(rgb: ByteArray) -> ByteArray:
    framed = cv2.copyMakeBorder(rgb, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=(120, 120, 120))
    return np.asarray(
        cv2.resize(framed, None, fx=ENLARGE, fy=ENLARGE, interpolation=cv2.INTER_NEAREST), np.uint8
    )
