"""The loop that small networks are trained by: resumable, on a time budget, on CPU or CUDA."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from safetensors.torch import save
from torch import Tensor, nn

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.networks import WEIGHTS_FILE, read_weights
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.runtime.targets import begin_run
from chord_usd.line.layout.description import CONFIG_FILE, FORMAT
from chord_usd.workshop.training.budget import Budget
from chord_usd.workshop.training.held_out import CURVE_FILE, HeldOut, curve_of, draw_curve
from chord_usd.workshop.training.memory import keep_freed_memory
from chord_usd.workshop.training.weights import Weights, warm_and_cool

STATE_FOLDER = "state"
LOG_FILE = "log.jsonl"
_LOG_STEPS = 50
_PROGRESS_STEPS = 10
_END_RATE = 0.02
"""Share of the learning rate at which a run ends."""

NetworkT = TypeVar("NetworkT", bound=nn.Module)
BatchT = TypeVar("BatchT")


@dataclass(frozen=True)
class RunConfig:
    """How to train."""

    minutes: float
    batch: int
    learning_rate: float
    warmup_steps: int
    cooldown_share: float
    """Last share of the budget in which the learning rate falls to a fiftieth."""
    weight_decay: float
    ema_decay: float
    gradient_clip: float = 1.0
    seed: int = 0
    device: str = "cpu"
    save_minutes: float = 0.5
    """After so many, the state of the run is saved: the most that a kill loses."""
    checkpoint_minutes: float = 5.0
    """After so many, the checkpoint is written, too."""
    processor_time: bool = False
    """Whether minutes are the processor's, of this process, not the clock's."""


@dataclass(frozen=True, eq=False)
class Lesson(Generic[NetworkT, BatchT]):
    """What a network learns."""

    batches: Callable[[int], Iterable[BatchT]]
    """From a seed: endless."""
    losses: Callable[[NetworkT, BatchT], Mapping[str, Tensor]]
    """By name; their sum is brought down."""
    score: Callable[[NetworkT], Mapping[str, Any]]
    """What the card says of the averaged network on held-out data."""
    write: Callable[[Path, NetworkT, dict[str, Any]], None]
    """Writes the averaged network and the facts about the run into a checkpoint folder."""
    take_up: Callable[[NetworkT, dict[str, Tensor]], object] = nn.Module.load_state_dict
    """Gives a network, on the CPU, the weights of a checkpoint. Raises KeyError or RuntimeError
    where they do not fit."""
    calibrate: Callable[[NetworkT], None] | None = None
    """Called with the averaged network before it is saved."""


def train(
    lesson: Lesson[NetworkT, BatchT],
    network: NetworkT,
    config: RunConfig,
    folder: Path,
    progress: Progress | None = None,
    start: Path | None = None,
) -> dict[str, Any]:
    """Run until the minutes are spent, going on where a run in the folder stopped.

    start: checkpoint whose weights a new run begins with.

    Returns what the card says of the run; the checkpoint comes to lie in folder/checkpoint, with
    the curve of its scores on held-out data. Raises CheckpointError where start does not fit.
    """
    begin_run(folder)
    keep_freed_memory()
    network.to(config.device)
    weights = Weights(network, config.learning_rate, config.weight_decay, config.ema_decay)
    before = weights.load(folder / STATE_FOLDER, config.device)
    if before is None:
        before = _begun(lesson, weights, start, config) if start else {"step": 0, "minutes": 0.0}
    step, minutes_before = int(before["step"]), float(before["minutes"])
    budget = Budget(config.minutes, processor_time=config.processor_time)
    log = _Log(folder / LOG_FILE)
    control = HeldOut(folder, lambda: lesson.score(_calibrated(lesson, weights)))
    facts: dict[str, Any] = {}
    for batch in lesson.batches(config.seed + step):
        rate = warm_and_cool(
            weights.taken, config.warmup_steps, budget.share, config.cooldown_share, _END_RATE
        )
        losses = lesson.losses(weights.network, batch)
        total = torch.stack(list(losses.values())).sum()
        weights.step(total, config.learning_rate * rate, config.gradient_clip)
        step += 1
        log.add(step, budget.spent, losses)
        if progress and step % _PROGRESS_STEPS == 0:
            progress(round(budget.spent * 60), round(config.minutes * 60))
        counters = {"step": step, "minutes": minutes_before + budget.spent}
        ended = budget.is_over
        if ended or budget.is_due("save", config.save_minutes):
            weights.save(folder / STATE_FOLDER, counters)
        if ended or budget.is_due("checkpoint", config.checkpoint_minutes):
            facts = _written(lesson, weights, config, folder, counters, control)
        else:
            control.take_if_due(budget, step, minutes_before)
        if ended:
            break
    return facts


def _begun(
    lesson: Lesson[NetworkT, Any], weights: Weights[NetworkT], start: Path, config: RunConfig
) -> dict[str, Any]:
    """Take up a checkpoint, and say how long it was trained."""
    stored = read_weights(start / WEIGHTS_FILE, "chord-usd train, or reinstall chord-usd")
    tensors = {name: torch.from_numpy(value).float() for name, value in stored.items()}
    for network in (weights.network, weights.average):
        try:
            lesson.take_up(network.to("cpu"), tensors)
        except (KeyError, RuntimeError) as error:
            raise CheckpointError(
                f"weights of another network ({str(error).splitlines()[0]})",
                where=str(start / WEIGHTS_FILE),
                expected="a checkpoint that the same verb wrote",
            ) from error
        network.to(config.device)
    weights.average.eval()
    trained = json.loads((start / CONFIG_FILE).read_text(encoding="utf-8"))["training"]
    return {"step": int(trained["steps"]), "minutes": float(trained["minutes"])}


def _calibrated(lesson: Lesson[NetworkT, Any], weights: Weights[NetworkT]) -> NetworkT:
    """The averaged network, ready to be scored."""
    if lesson.calibrate:
        lesson.calibrate(weights.average)
    return weights.average


def _written(
    lesson: Lesson[NetworkT, Any],
    weights: Weights[NetworkT],
    config: RunConfig,
    folder: Path,
    counters: Mapping[str, Any],
    control: HeldOut,
) -> dict[str, Any]:
    """Write the checkpoint and the curve, and return what its card says."""
    scores = control.take(counters["step"], counters["minutes"])
    facts = {
        **asdict(config), "steps": counters["step"], "minutes": round(counters["minutes"], 1),
        "date": date.today().isoformat(), **scores,
    }  # fmt: skip
    lesson.write(folder / "checkpoint", weights.average, facts)
    draw_curve(curve_of(folder), folder / "checkpoint" / CURVE_FILE)
    weights.average.to(config.device)
    return facts


class _Log:
    """Means of losses, a line every _LOG_STEPS steps."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.seen: dict[str, Tensor] = {}
        self.count = 0

    def add(self, step: int, minutes: float, losses: Mapping[str, Tensor]) -> None:
        for name, loss in losses.items():
            # Summed on the device: to ask for each would make the processor wait for it.
            value = loss.detach()
            self.seen[name] = self.seen[name] + value if name in self.seen else value.clone()
        self.count += 1
        if step % _LOG_STEPS == 0:
            means = {name: round(float(total) / self.count, 4) for name, total in self.seen.items()}
            row = json.dumps({"step": step, "minutes": round(minutes, 2), **means})
            with self.path.open("a", encoding="utf-8") as log:
                log.write(row + "\n")
            self.seen, self.count = {}, 0


def write_weights(folder: Path, network: nn.Module, description: Mapping[str, Any]) -> None:
    """The weights in half precision, and what is said about them, into a checkpoint folder."""
    folder.mkdir(parents=True, exist_ok=True)
    halves = {
        name: tensor.cpu().contiguous().to(torch.float16)
        for name, tensor in network.state_dict().items()
    }
    text = json.dumps({"format": FORMAT, **description}, indent=2)
    with checkpoint_files(folder):
        write_atomic(folder / WEIGHTS_FILE, save(halves))
        write_atomic(folder / CONFIG_FILE, (text + "\n").encode())
