"""Training of the network that reads pages: resumable, on a time budget, on CPU or CUDA."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.errors import CheckpointError
from chord_usd.layout.description import CONFIG_FILE, FORMAT
from chord_usd.raster.page_labels import (
    BUILT_NAMES,
    BUILT_WEIGHTS,
    KIND_NAMES,
    LAID_NAMES,
    POINT_NAMES,
    READER_INPUT,
    READER_OUTPUTS,
)
from chord_usd.runtime.checksums import checkpoint_files
from chord_usd.runtime.files import begin_run, write_atomic
from chord_usd.runtime.networks import WEIGHTS_FILE, read_weights
from chord_usd.runtime.progress import Progress
from chord_usd.training.budget import Budget
from chord_usd.training.memory import keep_freed_memory
from chord_usd.training.onnx_file import write_graph
from chord_usd.training.reader_data import (
    NO_KIND,
    Batch,
    Crop,
    PageStream,
    batch_of,
    page_loader,
)
from chord_usd.training.reader_network import (
    CHANNELS,
    OUTPUTS,
    ReaderNetwork,
    Reading,
    take_up_fused,
)
from chord_usd.training.weights import Weights, warm_and_cool

STATE_FOLDER = "state"
LOG_FILE = "log.jsonl"
_SAVE_MINUTES = 5.0
_LOG_STEPS = 20
_CALIBRATED_ON = 24
"""Batches."""
_TAKEN_UP_ON = 16
"""Crops."""
_END_RATE = 0.02
"""Share of the learning rate at which a run ends."""

_LAID_WEIGHTS = (1.0, 6.0, 2.5, 3.0)
"""Of the classes in the loss: thin ones have few pixels."""
_LAID_SHARE, _POINTS_SHARE, _OVERLAP_SHARE, _KINDS_SHARE = 0.5, 0.1, 0.3, 0.3
_LEAST_CHANCE = 1e-4
_LOSSES = ("built", "laid", "points", "overlap", "kinds")


@dataclass(frozen=True)
class ReaderTraining:
    """How to train."""

    minutes: float = 60.0
    batch: int = 4
    learning_rate: float = 2e-3
    warmup_steps: int = 50
    cooldown_share: float = 0.7
    """Last share of the budget in which the learning rate falls to a fiftieth."""
    weight_decay: float = 0.01
    ema_decay: float = 0.998
    gradient_clip: float = 1.0
    workers: int = 1
    seed: int = 0
    device: str = "cpu"


def train_reader(
    config: ReaderTraining,
    folder: Path,
    held_out: Sequence[Crop],
    progress: Progress | None = None,
    channels: tuple[int, ...] = CHANNELS,
    start: Path | None = None,
) -> dict[str, Any]:
    """Run until the minutes are spent, going on where a run in the folder stopped.

    start: checkpoint whose weights a new run begins with.

    Returns what the card says of the run; the checkpoint comes to lie in folder/checkpoint, and is
    renewed whenever the state is saved.
    """
    begin_run(folder)
    keep_freed_memory()
    torch.manual_seed(config.seed)
    network = ReaderNetwork(channels).to(config.device, memory_format=torch.channels_last)  # type: ignore[call-overload]
    weights = Weights(network, config.learning_rate, config.weight_decay, config.ema_decay)
    before = weights.load(folder / STATE_FOLDER, config.device)
    if before is None:
        before = _begun(weights, start, config) if start else {"step": 0, "minutes": 0.0}
    step = first_step = int(before["step"])
    budget, seen = Budget(config.minutes), torch.zeros(len(_LOSSES))
    pictures: deque[Tensor] = deque(maxlen=_CALIBRATED_ON)
    facts: dict[str, Any] = {}
    for told in page_loader(PageStream(config.batch, config.seed + step), config.workers):
        rate = warm_and_cool(
            step - first_step, config.warmup_steps, budget.share, config.cooldown_share, _END_RATE
        )
        batch = _moved(told, config.device)
        pictures.append(batch[0])
        losses = batch_losses(network, batch)
        weights.step(losses.sum(), config.learning_rate * rate, config.gradient_clip, step)
        step, seen = step + 1, seen + losses.detach().cpu()
        if step % _LOG_STEPS == 0:
            _log(folder, step, budget.spent, seen / min(_LOG_STEPS, step - first_step))
            seen = torch.zeros(len(_LOSSES))
        if progress and step % 10 == 0:
            progress(round(budget.spent * 60), round(config.minutes * 60))
        ended = budget.is_over
        if ended or budget.is_due("save", _SAVE_MINUTES):
            _calibrate(weights, pictures)
            minutes = before["minutes"] + budget.spent
            weights.save(folder / STATE_FOLDER, {"step": step, "minutes": minutes})
            facts = {
                **asdict(config), "steps": step, "minutes": round(minutes, 1),
                "held_out": score(weights.average, held_out, config.device),
            }  # fmt: skip
            write_checkpoint(folder / "checkpoint", weights.average, facts)
        if ended:
            break
    return facts


def _begun(weights: Weights[ReaderNetwork], start: Path, config: ReaderTraining) -> dict[str, Any]:
    """Take up a checkpoint, and say how long it was trained.

    Raises CheckpointError where it is damaged or of another size.
    """
    stored = read_weights(start / WEIGHTS_FILE, "chord-usd train reader, or reinstall chord-usd")
    tensors = {name: torch.from_numpy(value).float() for name, value in stored.items()}
    rgb = next(iter(PageStream(_TAKEN_UP_ON, config.seed)))[0].float() / 127.5 - 1.0
    for network in (weights.network, weights.average):
        network.to("cpu")
        try:
            take_up_fused(network, tensors, rgb)
        except (KeyError, RuntimeError) as error:
            raise CheckpointError(
                f"weights of another reader ({str(error).splitlines()[0]})",
                where=str(start / WEIGHTS_FILE),
                expected="a checkpoint that train reader wrote",
            ) from error
        network.to(config.device)
    weights.average.eval()
    told = json.loads((start / CONFIG_FILE).read_text(encoding="utf-8"))["training"]
    return {"step": int(told["steps"]), "minutes": float(told["minutes"])}


def _moved(batch: Batch, device: str) -> Batch:
    rgb, built, laid, heat, kinds = (part.to(device) for part in batch)
    return rgb, built, laid, heat, kinds


def _log(folder: Path, step: int, minutes: float, losses: Tensor) -> None:
    row = {name: round(float(loss), 4) for name, loss in zip(_LOSSES, losses, strict=True)}
    with (folder / LOG_FILE).open("a", encoding="utf-8") as log:
        log.write(json.dumps({"step": step, "minutes": round(minutes, 2), **row}) + "\n")


@torch.no_grad()
def _calibrate(weights: Weights[ReaderNetwork], pictures: Sequence[Tensor]) -> None:
    """Let the averaged network count what it normalises by, on pictures of the last steps.

    What the trained one has counted is of other weights, and costs a third of all rooms.
    """
    norms = [m for m in weights.average.modules() if isinstance(m, nn.BatchNorm2d)]
    for norm in norms:
        norm.reset_running_stats()
        norm.momentum = None  # a plain mean over all that follows
    weights.average.train()
    for rgb in pictures:
        logits_of(weights.average, rgb)
    weights.average.eval()


# Losses ------------------------------------------------------------------------------------------


def logits_of(network: ReaderNetwork, rgb: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """What the network says of uint8 colours: built, laid, points and kinds."""
    device = rgb.device.type
    with torch.autocast(device, torch.bfloat16, enabled=_has_halves(device)):
        scaled = (rgb.float() / 127.5 - 1.0).contiguous(memory_format=torch.channels_last)
        fine, kinds = network(scaled)
    built, laid, points = fine.float().split(OUTPUTS, dim=1)
    return built, laid, points, kinds.float()


def _has_halves(device: str) -> bool:
    """Whether half precision is faster: on processors that multiply it."""
    return device != "cpu" or torch.cpu._is_avx512_bf16_supported()


def batch_losses(network: ReaderNetwork, batch: Batch) -> Tensor:
    """(5,) losses of what is built, what is drawn over it, of points, of overlap, and of kinds."""
    rgb, built, laid, heat, kinds = batch
    said_built, said_laid, said_points, said_kinds = logits_of(network, rgb)
    device = rgb.device
    of_built = functional.cross_entropy(
        said_built, built.long(), torch.tensor(BUILT_WEIGHTS, device=device)
    )
    of_laid = functional.cross_entropy(
        said_laid, laid.long(), torch.tensor(_LAID_WEIGHTS, device=device)
    )
    of_points = _point_loss(said_points, heat.float() / 255)
    losses = (
        of_built, _LAID_SHARE * of_laid, _POINTS_SHARE * of_points,
        _OVERLAP_SHARE * (_overlap_loss(said_built, built) + _overlap_loss(said_laid, laid)),
        _KINDS_SHARE * _kinds_loss(said_kinds, kinds),
    )  # fmt: skip
    return torch.stack(losses)


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
    return (1 - (2 * both + 1) / (either + 1))[is_there].mean()


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
    found = {"crops": float(len(crops)), "kinds": round(right / max(floor, 1), 3)}
    for head, names in (("built", BUILT_NAMES), ("laid", LAID_NAMES)):
        for name, (both, guessed, really) in zip(names, counts[head].tolist(), strict=True):
            if really:
                found[name] = round(both / (guessed + really - both), 3)
    return found


def write_checkpoint(folder: Path, network: ReaderNetwork, facts: dict[str, Any]) -> None:
    """The weights in half precision, how to read with them, and where they come from."""
    folder.mkdir(parents=True, exist_ok=True)
    reading = Reading(network.cpu()).eval().to(memory_format=torch.contiguous_format)  # type: ignore[call-overload]
    halves = {
        name: tensor.contiguous().to(torch.float16)
        for name, tensor in reading.network.state_dict().items()
    }
    names = {"built": BUILT_NAMES, "laid": LAID_NAMES, "points": POINT_NAMES, "kinds": KIND_NAMES}
    with checkpoint_files(folder):
        write_atomic(folder / WEIGHTS_FILE, save(halves))
        description = json.dumps({"format": FORMAT, "labels": names, "training": facts}, indent=2)
        write_atomic(folder / CONFIG_FILE, (description + "\n").encode())
    axes = {0: "batch", 2: "height", 3: "width"}
    write_graph(
        folder,
        reading,
        stored={f"network.{name}": name for name in halves},
        inputs={READER_INPUT: torch.zeros(1, 3, 64, 64)},
        outputs=READER_OUTPUTS,
        free_axes={
            **dict.fromkeys((READER_INPUT, *READER_OUTPUTS), axes),
            "kinds": {0: "batch", 2: "rows", 3: "columns"},
        },
    )
