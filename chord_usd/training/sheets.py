"""Sample sheets: what the model draws for held-out plans, to be looked at."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import torch

from chord_usd import raster
from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.data.splits import TEST_SEED
from chord_usd.layout.checkpoint import Checkpoint
from chord_usd.layout.network import LayoutNetwork
from chord_usd.layout.sample import LayoutModel
from chord_usd.types import ByteArray

SHEET_PLANS = 4
ENLARGE = 2


def draw_sheet(
    network: LayoutNetwork, path: Path, device: torch.device, plans: int = SHEET_PLANS
) -> None:
    """Writes a PNG: a column per held-out plan; above what the furnisher drew, then two samples."""
    model = LayoutModel(Checkpoint(network, network.config, "", {}), str(device))
    houses = []
    for index in range(plans):
        rng = np.random.default_rng(TEST_SEED + index)
        houses.append(furnish(random_plan(rng), rng))
    images = [
        raster.draw_plan(house.plan, shade=index % 2 == 0) for index, house in enumerate(houses)
    ]
    truth = [
        raster.layout_image(image, house.items) for image, house in zip(images, houses, strict=True)
    ]
    steps = min(model.config.default_steps, 20)
    rows = [truth]
    for seed in range(2):
        rows.append(model.sample_batch(images, seeds=[seed] * plans, steps=steps))
    sheet = np.concatenate(
        [np.concatenate([_enlarged(image.rgb) for image in row], axis=1) for row in rows]
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(path), cv2.cvtColor(sheet, cv2.COLOR_RGB2BGR))


def _enlarged(rgb: ByteArray) -> ByteArray:
    framed = cv2.copyMakeBorder(rgb, 2, 2, 2, 2, cv2.BORDER_CONSTANT, value=(120, 120, 120))
    return np.asarray(
        cv2.resize(framed, None, fx=ENLARGE, fy=ENLARGE, interpolation=cv2.INTER_NEAREST), np.uint8
    )
