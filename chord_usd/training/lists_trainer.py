"""Training of the list network: resumable, on a time budget, on CPU or CUDA."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save
from torch import Tensor

from chord_usd.errors import CheckpointError
from chord_usd.layout.description import CONFIG_FILE, FORMAT
from chord_usd.lists.list_sampler import GRAPH_INPUTS, GRAPH_OUTPUTS
from chord_usd.lists.vocabulary import NOTHING, SEGMENT_FIELDS, Vocabulary
from chord_usd.runtime.checksums import checkpoint_files
from chord_usd.runtime.files import begin_run, write_atomic
from chord_usd.runtime.networks import WEIGHTS_FILE, read_weights
from chord_usd.runtime.progress import Progress
from chord_usd.training.budget import Budget
from chord_usd.training.lists_data import Batch
from chord_usd.training.lists_network import Drawing, ListNetwork
from chord_usd.training.onnx_file import write_graph
from chord_usd.training.weights import Weights, warm_and_cool

STATE_FOLDER = "state"
LOG_FILE = "log.jsonl"
_SAVE_MINUTES = 3.0
_LOG_STEPS = 100
_END_RATE = 0.02
"""Share of the learning rate at which a run ends."""


@dataclass(frozen=True, eq=False)
class Task:
    """What lists a network learns to write."""

    vocabulary: Vocabulary
    batches: Callable[[int], Iterator[Batch]]
    """From a seed: endless."""
    held_out: Batch | None = None
    """That no training sees."""


@dataclass(frozen=True)
class ListTraining:
    """How to train."""

    minutes: float = 60.0
    batch: int = 64
    learning_rate: float = 1e-3
    warmup_steps: int = 200
    cooldown_share: float = 0.5
    """Last share of the budget in which the learning rate falls to a fiftieth."""
    weight_decay: float = 0.02
    ema_decay: float = 0.999
    gradient_clip: float = 1.0
    seed: int = 0
    device: str = "cpu"


def train_lists(
    config: ListTraining,
    folder: Path,
    task: Task,
    progress: Progress | None = None,
    start: Path | None = None,
) -> dict[str, Any]:
    """Run until the minutes are spent, going on where a run in the folder stopped.

    start: checkpoint whose weights a new run begins with.

    Returns what the card says of the run; the checkpoint comes to lie in folder/checkpoint, and is
    renewed whenever the state is saved.
    """
    begin_run(folder)
    torch.manual_seed(config.seed)
    network = ListNetwork(task.vocabulary).to(config.device)
    weights = Weights(network, config.learning_rate, config.weight_decay, config.ema_decay)
    before = weights.load(folder / STATE_FOLDER, config.device)
    if before is None:
        before = _begun(weights, start) if start else {"step": 0, "minutes": 0.0}
    step = first_step = int(before["step"])
    budget, seen = Budget(config.minutes), 0.0
    facts: dict[str, Any] = {}
    for told in task.batches(config.seed + step):
        batch = _moved(told, config.device)
        rate = warm_and_cool(
            step - first_step, config.warmup_steps, budget.share, config.cooldown_share, _END_RATE
        )
        loss = batch_loss(network, batch).mean()
        weights.step(loss, config.learning_rate * rate, config.gradient_clip, step)
        step, seen = step + 1, seen + float(loss.detach())
        if step % _LOG_STEPS == 0:
            _log(folder, {"step": step, "nats": seen / _LOG_STEPS, "minutes": budget.spent})
            seen = 0.0
        if progress and step % 25 == 0:
            progress(round(budget.spent * 60), round(config.minutes * 60))
        ended = budget.is_over
        if ended or budget.is_due("save", _SAVE_MINUTES):
            minutes = before["minutes"] + budget.spent
            weights.save(folder / STATE_FOLDER, {"step": step, "minutes": minutes})
            facts = {
                **asdict(config), "steps": step, "minutes": round(minutes, 1),
                "held_out_nats": _score(weights.average, task.held_out, config.device),
            }  # fmt: skip
            write_checkpoint(folder / "checkpoint", weights.average, task.vocabulary, facts)
        if ended:
            break
    return facts


def _begun(weights: Weights[ListNetwork], start: Path) -> dict[str, Any]:
    """Take up a checkpoint, and say how long it was trained.

    Raises CheckpointError where it is damaged or of another vocabulary.
    """
    stored = read_weights(start / WEIGHTS_FILE, "chord-usd train lists, or reinstall chord-usd")
    tensors = {name: torch.from_numpy(value).float() for name, value in stored.items()}
    for network in (weights.network, weights.average):
        try:
            network.load_state_dict(tensors)
        except RuntimeError as error:
            raise CheckpointError(
                f"weights of another list network ({str(error).splitlines()[0]})",
                where=str(start / WEIGHTS_FILE),
                expected="a checkpoint that train lists wrote, of the same --of",
            ) from error
    told = json.loads((start / CONFIG_FILE).read_text(encoding="utf-8"))["training"]
    return {"step": int(told["steps"]), "minutes": float(told["minutes"])}


def _moved(batch: Batch, device: str) -> Batch:
    segments, facts, flags, roles, left, values = (part.to(device) for part in batch)
    return segments, facts, flags, roles, left, values


def _log(folder: Path, row: dict[str, Any]) -> None:
    with (folder / LOG_FILE).open("a", encoding="utf-8") as log:
        log.write(json.dumps(row) + "\n")


def batch_loss(network: ListNetwork, batch: Batch) -> Tensor:
    """(B,) negative log likelihood of each list, in nats."""
    chances: Tensor = network(*batch)
    return -chances.sum(dim=1)


@torch.inference_mode()
def _score(network: ListNetwork, held_out: Batch | None, device: str) -> float | None:
    """Mean nats a held-out list takes."""
    if held_out is None:
        return None
    return round(float(batch_loss(network, _moved(held_out, device)).mean()), 3)


def write_checkpoint(
    folder: Path, network: ListNetwork, vocabulary: Vocabulary, facts: dict[str, Any]
) -> None:
    """The weights in half precision, how to draw with them, and where they come from."""
    folder.mkdir(parents=True, exist_ok=True)
    halves = {name: t.cpu().to(torch.float16) for name, t in network.state_dict().items()}
    with checkpoint_files(folder):
        write_atomic(folder / WEIGHTS_FILE, save(halves))
        description = json.dumps({"format": FORMAT, "training": facts}, indent=2)
        write_atomic(folder / CONFIG_FILE, (description + "\n").encode())
    example = {
        "segments": torch.ones(1, 2, SEGMENT_FIELDS, dtype=torch.long),
        "facts": torch.zeros(1, len(vocabulary.facts), dtype=torch.long),
        "flags": torch.zeros(1, vocabulary.flags),
        "roles": torch.zeros(1, 2, dtype=torch.long),
        "left": torch.zeros(1, 2, dtype=torch.long),
        "values": torch.full((1, 2, len(vocabulary.slots)), NOTHING, dtype=torch.long),
        "noise": torch.zeros(1, len(vocabulary.slots), vocabulary.size),
    }
    axes = {0: "batch", 1: "positions"}
    rows = {name: {0: "batch"} for name in ("facts", "flags", "noise", *GRAPH_OUTPUTS)}
    write_graph(
        folder,
        Drawing(network.cpu()),
        stored={f"network.{name}": name for name in network.state_dict()},
        inputs={name: example[name] for name in GRAPH_INPUTS},
        outputs=GRAPH_OUTPUTS,
        free_axes={
            "segments": {0: "batch", 1: "segments"},
            **dict.fromkeys(("roles", "left", "values"), axes),
            **rows,
        },
    )
