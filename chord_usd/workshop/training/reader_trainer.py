"""Training of the network that reads pages."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.base.raster.page_labels import (
    BUILT_NAMES,
    BUILT_WEIGHTS,
    KIND_NAMES,
    LAID_NAMES,
    POINT_NAMES,
    READER_INPUT,
    READER_OUTPUTS,
)
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import Plan
from chord_usd.workshop.training.loader import batches_ahead
from chord_usd.workshop.training.loop import Lesson, RunConfig, train, write_weights
from chord_usd.workshop.training.onnx_file import write_graph
from chord_usd.workshop.training.reader_data import (
    NO_KIND,
    Batch,
    Crop,
    PageStream,
    batch_of,
)
from chord_usd.workshop.training.reader_network import (
    CHANNELS,
    OUTPUTS,
    ReaderNetwork,
    Reading,
    take_up_fused,
)

_CALIBRATED_ON = 24
"""Batches."""
_TAKEN_UP_ON = 16
"""Crops."""

_LAID_WEIGHTS = (1.0, 6.0, 2.5, 3.0)
"""Of the classes in the loss: thin ones have few pixels."""
_LAID_SHARE, _POINTS_SHARE, _OVERLAP_SHARE, _KINDS_SHARE = 0.5, 0.1, 0.3, 0.3
_LEAST_CHANCE = 1e-4
_LOSSES = ("built", "laid", "points", "overlap", "kinds")


@dataclass(frozen=True)
class ReaderTraining(RunConfig):
    """How to train."""

    minutes: float = 60.0
    batch: int = 4
    learning_rate: float = 2e-3
    warmup_steps: int = 50
    cooldown_share: float = 0.7
    weight_decay: float = 0.01
    ema_decay: float = 0.998
    workers: int = 1
    kinds_only: bool = False
    """Whether all but the head for kinds of floors stays as it is at the start."""


ON_GPU = ReaderTraining(
    batch=32, learning_rate=3e-3, warmup_steps=200, cooldown_share=0.6, ema_decay=0.9992,
    save_minutes=6.0,
)  # fmt: skip


def train_reader(
    config: ReaderTraining,
    folder: Path,
    held_out: Sequence[Crop],
    progress: Progress | None = None,
    channels: tuple[int, ...] = CHANNELS,
    start: Path | None = None,
    flats: Sequence[Plan] = (),
) -> dict[str, Any]:
    """Train as loop.train does, and return what the card says of the run.

    held_out: to be scored on; flats: to be drawn beside procedural plans."""
    torch.manual_seed(config.seed)
    network = ReaderNetwork(channels).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
    pictures: deque[Tensor] = deque(maxlen=_CALIBRATED_ON)

    if config.kinds_only:
        network.keep_all_but_kinds()

    is_cuda = config.device.startswith("cuda")

    def losses(network: ReaderNetwork, raw: Batch) -> dict[str, Tensor]:
        batch = _moved(raw, config.device)
        pictures.append(batch[0])
        if config.kinds_only:
            return {"kinds": _kinds_loss(kinds_of(network, batch[0]), batch[-1])}
        return dict(zip(_LOSSES, batch_losses(network, batch), strict=True))

    lesson = Lesson(
        lambda seed: batches_ahead(
            PageStream(config.batch, seed, flats=flats), config.workers, pinned=is_cuda
        ),
        losses,
        score=lambda network: {"held_out": score(network, held_out, config.device)},
        write=write_checkpoint,
        take_up=lambda network, tensors: take_up_fused(network, tensors, _first_pages(config.seed)),
        calibrate=lambda network: _calibrate(network, pictures),
    )
    return train(lesson, network, config, folder, progress, start)


def _first_pages(seed: int) -> Tensor:
    """Inputs of a network whose normalisation is to be measured again."""
    return next(iter(PageStream(_TAKEN_UP_ON, seed)))[0].float() / 127.5 - 1.0


def _moved(batch: Batch, device: str) -> Batch:
    rgb, built, laid, heat, kinds = (part.to(device, non_blocking=True) for part in batch)
    return rgb, built, laid, heat, kinds


@torch.no_grad()
def _calibrate(average: ReaderNetwork, pictures: Iterable[Tensor]) -> None:
    """Let the averaged network count what it normalises by, on pictures of the last steps.

    What the trained one has counted is of other weights, and costs a third of all rooms.
    """
    norms = [m for m in average.modules() if isinstance(m, nn.BatchNorm2d)]
    for norm in norms:
        norm.reset_running_stats()
        norm.momentum = None  # a plain mean over all that follows
    average.train()
    for rgb in pictures:
        logits_of(average, rgb)
    average.eval()


# Losses ------------------------------------------------------------------------------------------


def logits_of(network: ReaderNetwork, rgb: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """What the network says of uint8 colours: built, laid, points and kinds."""
    with _precision(rgb):
        fine, kinds = network(_scaled(rgb))
    built, laid, points = fine.float().split(OUTPUTS, dim=1)
    return built, laid, points, kinds.float()


def kinds_of(network: ReaderNetwork, rgb: Tensor) -> Tensor:
    """Logits of kinds, of uint8 colours."""
    with _precision(rgb):
        return network.kinds_of(_scaled(rgb)).float()


def _scaled(rgb: Tensor) -> Tensor:
    return (rgb.float() / 127.5 - 1.0).contiguous(memory_format=torch.channels_last)


def _precision(rgb: Tensor) -> torch.autocast:
    device = rgb.device.type
    return torch.autocast(device, torch.bfloat16, enabled=_has_halves(device))


def _has_halves(device: str) -> bool:
    """Whether half precision is faster: on processors that multiply it."""
    return device != "cpu" or torch.cpu._is_avx512_bf16_supported()


def batch_losses(network: ReaderNetwork, batch: Batch) -> Tensor:
    """(5,) losses of what is built, what is drawn over it, of points, of overlap, and of kinds."""
    rgb, built, laid, heat, kinds = batch
    said_built, said_laid, said_points, said_kinds = logits_of(network, rgb)
    device = str(rgb.device)
    of_built = functional.cross_entropy(said_built, built.long(), _on(device, BUILT_WEIGHTS))
    of_laid = functional.cross_entropy(said_laid, laid.long(), _on(device, _LAID_WEIGHTS))
    of_points = _point_loss(said_points, heat.float() / 255)
    losses = (
        of_built, _LAID_SHARE * of_laid, _POINTS_SHARE * of_points,
        _OVERLAP_SHARE * (_overlap_loss(said_built, built) + _overlap_loss(said_laid, laid)),
        _KINDS_SHARE * _kinds_loss(said_kinds, kinds),
    )  # fmt: skip
    return torch.stack(losses)


@cache
def _on(device: str, values: tuple[float, ...]) -> Tensor:
    return torch.tensor(values, device=device)


def _point_loss(said: Tensor, heat: Tensor) -> Tensor:
    """Focal loss about points (Objects as Points, section 4), per point."""
    chance = said.sigmoid().clamp(_LEAST_CHANCE, 1 - _LEAST_CHANCE)
    is_point = heat > 0.999
    hit = is_point * (1 - chance) ** 2 * chance.log()
    miss = ~is_point * (1 - heat) ** 4 * chance**2 * (1 - chance).log()
    return -(hit + miss).sum() / is_point.sum().clamp(min=1)


def _kinds_loss(said: Tensor, kinds: Tensor) -> Tensor:
    """Cross-entropy on floors; zero where a batch has none."""
    each = functional.cross_entropy(said, kinds.long(), ignore_index=NO_KIND, reduction="sum")
    return each / (kinds != NO_KIND).sum().clamp(min=1)


def _overlap_loss(said: Tensor, labels: Tensor) -> Tensor:
    """One minus the soft overlap (Dice) of each class that is there; a door counts as much as a
    floor."""
    chances = said.softmax(dim=1)
    true = functional.one_hot(labels.long(), said.shape[1]).permute(0, 3, 1, 2).to(chances.dtype)
    both = (chances * true).sum(dim=(0, 2, 3))
    either = (chances + true).sum(dim=(0, 2, 3))
    is_there = true.sum(dim=(0, 2, 3)) > 0
    return (is_there * (1 - (2 * both + 1) / (either + 1))).sum() / is_there.sum()


# Scores and checkpoints --------------------------------------------------------------------------


@torch.inference_mode()
def score(network: ReaderNetwork, crops: Sequence[Crop], device: str) -> dict[str, float]:
    """Intersection over union of each class over all crops, classes that are nowhere left out; and
    kinds: the share of floor whose kind is right."""
    if not crops:
        return {}
    network.eval()
    counts = {"built": torch.zeros(OUTPUTS[0], 3), "laid": torch.zeros(OUTPUTS[1], 3)}
    right, floor = 0, 0
    for crop in crops:
        rgb, built, laid, _, kinds = _moved(batch_of([crop]), device)
        said_built, said_laid, _, said_kinds = logits_of(network, rgb)
        right += int((said_kinds.argmax(dim=1) == kinds).sum())
        floor += int((kinds != NO_KIND).sum())
        for head, said, true in (("built", said_built, built), ("laid", said_laid, laid)):
            guess = said.argmax(dim=1)
            for kind, row in enumerate(counts[head]):
                guesses, truths = guess == kind, true == kind
                both = guesses & truths
                row += torch.stack([both.sum(), guesses.sum(), truths.sum()]).cpu()
    scores = {"crops": float(len(crops)), "kinds": round(right / max(floor, 1), 3)}
    for head, names in (("built", BUILT_NAMES), ("laid", LAID_NAMES)):
        for name, (both, guessed, really) in zip(names, counts[head].tolist(), strict=True):
            if really:
                scores[name] = round(both / (guessed + really - both), 3)
    return scores


def write_checkpoint(folder: Path, network: ReaderNetwork, facts: dict[str, Any]) -> None:
    """The weights in half precision, how to read with them, and where they come from."""
    reading = Reading(network.cpu()).eval().to(memory_format=torch.contiguous_format)  # type: ignore[call-overload]
    names = {"built": BUILT_NAMES, "laid": LAID_NAMES, "points": POINT_NAMES, "kinds": KIND_NAMES}
    write_weights(folder, reading.network, {"labels": names, "training": facts})
    axes = {0: "batch", 2: "height", 3: "width"}
    write_graph(
        folder,
        reading,
        stored={f"network.{name}": name for name in reading.network.state_dict()},
        inputs={READER_INPUT: torch.zeros(1, 3, 64, 64)},
        outputs=READER_OUTPUTS,
        free_axes={
            **dict.fromkeys((READER_INPUT, *READER_OUTPUTS), axes),
            "kinds": {0: "batch", 2: "rows", 3: "columns"},
        },
    )
