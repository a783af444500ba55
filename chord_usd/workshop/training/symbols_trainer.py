"""Training of the network that finds drawn furniture and fixtures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor

from chord_usd.base.raster.page_labels import (
    PIECE_M_PER_PX,
    PIECE_NAMES,
    PIECE_STEP_PX,
    PIECES_OUTPUTS,
    READER_INPUT,
)
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import FloatArray
from chord_usd.workshop.training.loader import batches_ahead
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.onnx_file import write_graph
from chord_usd.workshop.training.symbols_data import Batch, Crop, SymbolStream, batch_of
from chord_usd.workshop.training.symbols_network import Finding, SymbolsNetwork, take_up

_SHAPE_WEIGHTS = (1.0, 1.0, 1.0, 1.0, 0.7, 0.7)
_LEAST_CHANCE = 1e-4
_SCORED_AT = 0.35
"""Chance from which a piece counts in the scores."""
_NEAR_M, _SAME_WAY = 0.25, 0.866
"""How near a centre has to be, and how near a direction: the cosine."""
_LEAST_LOOKED_AT = 0.15
_PRECISION, _LEAST_SURE = 0.85, (0.3, 0.6)
"""Share of pieces that are right from the least chance on, and bounds of that chance."""
_AT_ONCE = 8


IndexArray = npt.NDArray[np.int64]


@dataclass(frozen=True)
class SymbolsTraining(RunConfig):
    """How to train."""

    minutes: float = 60.0
    batch: int = 8
    learning_rate: float = 1e-3
    warmup_steps: int = 60
    cooldown_share: float = 0.6
    weight_decay: float = 0.01
    ema_decay: float = 0.998
    workers: int = 1


def train_symbols(
    config: SymbolsTraining,
    folder: Path,
    held_out: Sequence[Crop],
    progress: Progress | None = None,
    start: Path | None = None,
) -> dict[str, Any]:
    """Train as loop.train does, and return what the card says of the run.

    start: checkpoint of this network, or of the one that reads pages. held_out: to be scored on.
    """
    torch.manual_seed(config.seed)
    network = SymbolsNetwork().to(memory_format=torch.channels_last)  # type: ignore[call-overload]

    def losses(network: SymbolsNetwork, batch: Batch) -> dict[str, Tensor]:
        rgb, hills, shapes, said = (part.to(config.device) for part in batch)
        centres, guessed = _seen(network, rgb)
        return {
            "centres": _centre_loss(centres, hills.float() / 255),
            "shapes": _shape_loss(guessed, shapes, said),
        }

    lesson = Lesson(
        lambda seed: batches_ahead(SymbolStream(config.batch, seed), config.workers),
        losses,
        score=lambda network: {"held_out": score(network, held_out, config.device)},
        write=lambda folder, network, facts: write_checkpoint(
            folder, network, facts, least_chances(network, held_out, config.device)
        ),
        take_up=take_up,
    )
    return train(lesson, network, config, folder, progress, start)


def _seen(network: SymbolsNetwork, rgb: Tensor) -> tuple[Tensor, Tensor]:
    scaled = (rgb.float() / 127.5 - 1.0).contiguous(memory_format=torch.channels_last)
    device = rgb.device.type
    has_halves = device != "cpu" or torch.cpu._is_avx512_bf16_supported()
    with torch.autocast(device, torch.bfloat16, enabled=has_halves):
        centres, shapes = network(scaled)
    return centres.float(), shapes.float()


def _centre_loss(said: Tensor, hills: Tensor) -> Tensor:
    """Focal loss about centres (Objects as Points, section 4), per piece."""
    chance = said.sigmoid().clamp(_LEAST_CHANCE, 1 - _LEAST_CHANCE)
    is_centre = hills > 0.999
    hit = is_centre * (1 - chance) ** 2 * chance.log()
    miss = ~is_centre * (1 - hills) ** 4 * chance**2 * (1 - chance).log()
    return -(hit + miss).sum() / is_centre.sum().clamp(min=1)


def _shape_loss(guessed: Tensor, shapes: Tensor, said: Tensor) -> Tensor:
    """Mean absolute error at centres; a front may be the back where a piece is alike from both."""
    error = (guessed - shapes).abs()
    back = (guessed[:, 4:] + shapes[:, 4:]).abs()
    is_turned = (said == 2)[:, None] & (
        back.sum(dim=1, keepdim=True) < error[:, 4:].sum(dim=1, keepdim=True)
    )
    error = torch.cat([error[:, :4], torch.where(is_turned, back, error[:, 4:])], dim=1)
    weights = torch.tensor(_SHAPE_WEIGHTS, device=error.device)[:, None, None]
    is_said = (said > 0)[:, None]
    return (error * weights * is_said).sum() / is_said.sum().clamp(min=1)


# Scores and checkpoints --------------------------------------------------------------------------


def peaks(chances: Tensor, least: float) -> Tensor:
    """(N, 4) image, kind, row and column of the cells that are likelier than all beside them."""
    top = torch.nn.functional.max_pool2d(chances, 3, stride=1, padding=1)
    return ((chances == top) & (chances >= least)).nonzero()


@dataclass(frozen=True, eq=False)
class _Found:
    """What was found on held-out crops."""

    chances: list[list[float]]
    """By category; rights: whether each is right within 25 cm."""
    rights: list[list[bool]]
    there: npt.NDArray[np.int64]
    """(K,) how many pieces are there."""
    turns: list[bool]
    """Of right ones, whether each looks the right way."""


@torch.inference_mode()
def _find(network: SymbolsNetwork, crops: Sequence[Crop], device: str) -> _Found:
    kinds = range(len(PIECE_NAMES))
    kind_of = [crop.pieces[:, 0].astype(int) for crop in crops]
    there = np.bincount(np.concatenate(kind_of), minlength=len(kinds))
    finds = _Found([[] for _ in kinds], [[] for _ in kinds], there, [])
    network.eval()
    for start in range(0, len(crops), _AT_ONCE):
        part = crops[start : start + _AT_ONCE]
        rgb = batch_of(part)[0].to(device)
        centres, shapes = _seen(network, rgb)
        mirrored = _seen(network, rgb.flip(-1))[0].flip(-1)
        chances = ((centres.sigmoid() + mirrored.sigmoid()) / 2).cpu()
        cells = peaks(chances, _LEAST_LOOKED_AT)
        for index, crop in enumerate(part):
            mine = cells[cells[:, 0] == index]
            sure = chances[mine[:, 0], mine[:, 1], mine[:, 2], mine[:, 3]]
            order = sure.argsort(descending=True)
            _match(
                crop, mine[order].numpy(), sure[order].tolist(), shapes[index].cpu().numpy(), finds
            )
    network.train()
    return finds


def _match(
    crop: Crop, cells: IndexArray, sure: Sequence[float], shapes: FloatArray, finds: _Found
) -> None:
    """Note of each cell, the surest first, whether it is right."""
    free = np.ones(len(crop.pieces), bool)
    for (_, kind, row, column), chance in zip(cells, sure, strict=True):
        x, y, _, _, front_x, front_y = shapes[:, row, column]
        at = np.array([column + x, row + y]) * PIECE_STEP_PX
        off = np.hypot(*(crop.pieces[:, 1:3] - at).T)
        off[~free | (crop.pieces[:, 0] != kind)] = np.inf
        is_right = bool(len(off) and off.min() <= _NEAR_M / PIECE_M_PER_PX)
        finds.chances[kind].append(chance)
        finds.rights[kind].append(is_right)
        if is_right:
            nearest = int(off.argmin())
            free[nearest] = False
            along = crop.pieces[nearest, 5:7] @ (front_x, front_y)
            finds.turns.append(bool(along > _SAME_WAY * np.hypot(front_x, front_y)))


def score(network: SymbolsNetwork, crops: Sequence[Crop], device: str) -> dict[str, float]:
    """F1 of each category, over all crops: right within 25 cm; of those, the share whose front is
    right within 30 degrees."""
    finds = _find(network, crops, device)
    counts = np.zeros((len(PIECE_NAMES), 3))
    for kind, really in enumerate(finds.there.tolist()):
        is_sure = np.array(finds.chances[kind]) >= _SCORED_AT
        right = np.array(finds.rights[kind], bool)[is_sure]
        counts[kind] = right.sum(), is_sure.sum(), really
    scores = {"direction": round(float(np.mean(finds.turns)), 3)} if finds.turns else {}
    for name, (both, guessed, really) in zip(PIECE_NAMES, counts.tolist(), strict=True):
        if really:
            scores[name] = round(2 * both / (guessed + really), 3)
    both, guessed, really = counts.sum(axis=0).tolist()
    return {"all": round(2 * both / max(guessed + really, 1), 3), **scores}


def least_chances(network: SymbolsNetwork, crops: Sequence[Crop], device: str) -> dict[str, float]:
    """By category, the least chance from which on _PRECISION of what is found is right."""
    finds = _find(network, crops, device)
    least = {}
    for name, chances, rights in zip(PIECE_NAMES, finds.chances, finds.rights, strict=True):
        order = np.argsort(chances)[::-1]
        precision = np.cumsum(np.array(rights, float)[order]) / np.arange(1, len(order) + 1)
        enough = np.flatnonzero(precision >= _PRECISION)
        chance = chances[order[enough[-1]]] if len(enough) else _LEAST_SURE[1]
        least[name] = round(float(np.clip(chance, *_LEAST_SURE)), 3)
    return least


def write_checkpoint(
    folder: Path,
    network: SymbolsNetwork,
    facts: dict[str, Any],
    least: Mapping[str, float] | None = None,
) -> None:
    """The weights in half precision, how to find with them, and where they come from.

    least: by category, the chance from which on a piece counts."""
    finding = Finding(network.cpu()).eval().to(memory_format=torch.contiguous_format)  # type: ignore[call-overload]
    description = {"labels": list(PIECE_NAMES), "least": dict(least or {}), "training": facts}
    write_weights(folder, network, description)
    axes = {0: "batch", 2: "height", 3: "width"}
    cells = {0: "batch", 2: "rows", 3: "columns"}
    write_graph(
        folder,
        finding,
        stored={f"network.{name}": name for name in network.state_dict()},
        inputs={READER_INPUT: torch.zeros(1, 3, 64, 64)},
        outputs=PIECES_OUTPUTS,
        free_axes={READER_INPUT: axes, **dict.fromkeys(PIECES_OUTPUTS, cells)},
    )
