"""State of a training run: a network, its moving average and the moments of Adam."""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save
from torch import Tensor, nn
from torch.nn import functional

from chord_usd.base.errors import CheckpointError
from chord_usd.workshop.training.processes import Processes

_MOMENTS = {"exp_avg": 3, "exp_avg_sq": 4}
"""What Adam keeps of each weight, and the root by which eight_bits stores it."""
_SCALES = ".scales"
_AVERAGE_POWER = 17.97
"""The average weighs step s of t by (s / t) to this power less one: it spans the last 5 % of a run,
long or short (Karras et al., Analyzing and Improving the Training Dynamics of Diffusion Models,
2024, section 3.1)."""
WARM_SHARE = 0.03
"""Share of a budget after which the learning rate is full, however few steps that is."""

NetworkT = TypeVar("NetworkT", bound=nn.Module)


def warm_and_cool(
    steps: int, warmup_steps: int, spent: float, cooldown_share: float, end: float
) -> float:
    """Factor of the learning rate: up to 1 over a run's first steps, down to end over the last
    share of its budget.

    steps: taken before, since the optimiser began; warmup_steps: full rate at the latest;
    spent: share of the budget, in [0, 1], full rate from WARM_SHARE on.
    """
    warm = min(1.0, max((steps + 1) / max(warmup_steps, 1), spent / WARM_SHARE))
    into_cooldown = max(0.0, spent - 1.0 + cooldown_share) / cooldown_share
    return warm * (1.0 - (1.0 - end) * into_cooldown)


class Weights(Generic[NetworkT]):
    """A network in training."""

    def __init__(
        self,
        network: NetworkT,
        learning_rate: float,
        weight_decay: float,
        decay: float,
        processes: Processes | None = None,
    ) -> None:
        """decay: of the average, at most; runs too short for it average over their last 5 %.

        processes: whose gradients are averaged.
        """
        self.processes = processes
        self.network = network
        self.decay = decay
        self.taken = 0
        """Steps since the optimiser began; a resumed run goes on counting."""
        self.average = copy.deepcopy(network).eval()
        self.average.requires_grad_(False)
        learning = self._learning().values()
        on_cpu = all(parameter.device.type == "cpu" for parameter in learning)
        self.optimiser = torch.optim.AdamW(
            learning, learning_rate, weight_decay=weight_decay, fused=on_cpu
        )

    def _learning(self) -> dict[str, nn.Parameter]:
        """By name: what is not frozen."""
        return {name: p for name, p in self.network.named_parameters() if p.requires_grad}

    def step(self, loss: Tensor, learning_rate: float, clip: float) -> None:
        """One step down the gradient of a loss, gradients clipped to a norm; then the average."""
        for group in self.optimiser.param_groups:
            group["lr"] = learning_rate
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        if self.processes:
            self.processes.average_gradients(self.network.parameters())
        nn.utils.clip_grad_norm_(self.network.parameters(), clip)
        self.optimiser.step()
        self.taken += 1
        self._update_average()

    @torch.no_grad()
    def _update_average(self) -> None:
        decay = min(self.decay, (1.0 - 1.0 / self.taken) ** _AVERAGE_POWER)
        averages = [parameter.data for parameter in self.average.parameters()]
        current = [parameter.data for parameter in self.network.parameters()]
        torch._foreach_lerp_(averages, current, 1.0 - decay)

    def save(self, folder: Path, counters: Mapping[str, Any]) -> None:
        """Write all of it and the counters into a folder that load reads (training_state.py).

        Eight bytes a weight: the weights in full, half precision for averages, 8 bits for moments.
        """
        tensors = {f"network.{name}": t for name, t in self.network.state_dict().items()}
        for name, average in self.average.state_dict().items():
            tensors[f"average.{name}"] = average.to(torch.float16)
        for name, parameter in self._learning().items():
            for key, root in _MOMENTS.items():
                moment = self.optimiser.state[parameter][key]
                codes, scales = pack(moment, root)
                tensors |= {f"{key}.{name}": codes, f"{key}.{name}{_SCALES}": scales}
        save_state(folder, tensors, {**counters, "optimiser_steps": self.taken})

    def load(self, folder: Path, device: str) -> dict[str, Any] | None:
        """Take up what save wrote and return its counters; None where there is nothing.

        Raises CheckpointError where it is damaged or of another version.
        """
        stored = load_state(folder, device)
        if stored is None:
            return None
        tensors, counters = stored
        self.network.load_state_dict(_below(tensors, "network"))
        self.average.load_state_dict(_below(tensors, "average"))
        self.taken = int(counters["optimiser_steps"])
        for name, parameter in self._learning().items():
            state = {"step": torch.tensor(float(self.taken))}
            for key, root in _MOMENTS.items():
                codes, scales = tensors[f"{key}.{name}"], tensors[f"{key}.{name}{_SCALES}"]
                state[key] = unpack(codes, scales, root).reshape(parameter.shape).to(parameter)
            self.optimiser.state[parameter] = state
        return counters


def _below(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """The tensors whose names begin so, without the prefix, in float32."""
    return {
        name.removeprefix(f"{prefix}."): tensor.float()
        for name, tensor in tensors.items()
        if name.startswith(f"{prefix}.")
    }


# Tensors in 8 bits, block by block, for the parts of a training state that may be coarse ---------

# Values are stored as roots, so that the small values of a block keep their relative size: Adam
# divides by the second moment, and a second moment rounded to zero would make a step explode.

BLOCK = 256
"""Values that share a scale."""
_LEVELS = 127


def pack(values: Tensor, root: int) -> tuple[Tensor, Tensor]:
    """Codes (N,) int8 and scales (ceil(N / BLOCK),) float32 of a tensor of N values.

    root: 1 stores values evenly spaced; larger roots resolve small values better. A value other
    than zero never becomes zero where root is above 1.
    """
    flat = values.detach().float().reshape(-1)
    blocks = functional.pad(flat, (0, -len(flat) % BLOCK)).reshape(-1, BLOCK)
    scales = blocks.abs().amax(dim=1)
    relative = blocks / scales.clamp(min=torch.finfo(torch.float32).tiny)[:, None]
    levels = (relative.abs() ** (1.0 / root) * _LEVELS).round()
    if root > 1:
        levels = torch.where(relative != 0.0, levels.clamp(min=1.0), levels)
    codes = (levels * relative.sign()).to(torch.int8).reshape(-1)[: len(flat)]
    return codes.contiguous(), scales


def unpack(codes: Tensor, scales: Tensor, root: int) -> Tensor:
    """(N,) float32: the inverse of pack."""
    relative = codes.float() / _LEVELS
    each = scales.repeat_interleave(BLOCK)[: len(codes)]
    return relative.sign() * relative.abs() ** root * each


# The state of a training run as a folder of small files, so that it travels through --------------

# Machines with a GPU are often at hand for minutes, behind limits on how large a file may be.

MAX_SHARD_BYTES = 15 * 2**20
INDEX_FILE = "state.json"
FORMAT = 2


def save_state(folder: Path, tensors: Mapping[str, Tensor], counters: Mapping[str, Any]) -> None:
    """Writes tensors and counters into folder, replacing it as a whole; shards of 15 MiB at most.

    Names may not hold '#': it numbers the parts of a tensor too large for one shard.
    """
    partial = folder.with_name(folder.name + ".part")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    try:
        _write(partial, tensors, counters)
    except BaseException:  # on a full disk every byte counts
        shutil.rmtree(partial, ignore_errors=True)
        raise
    former = folder.with_name(folder.name + ".old")
    shutil.rmtree(former, ignore_errors=True)
    if folder.exists():
        folder.rename(former)
    partial.rename(folder)
    shutil.rmtree(former, ignore_errors=True)


def _write(folder: Path, tensors: Mapping[str, Tensor], counters: Mapping[str, Any]) -> None:
    count = 0
    for shard in _shards(tensors):
        # Not save_file: it leaves a file that only its owner can read.
        (folder / f"{count:02d}.safetensors").write_bytes(save(shard))
        count += 1
    shapes = {name: list(tensor.shape) for name, tensor in tensors.items()}
    index = {"format": FORMAT, "shards": count, "shapes": shapes, "counters": dict(counters)}
    (folder / INDEX_FILE).write_text(json.dumps(index) + "\n", encoding="utf-8")


def load_state(folder: Path, device: str) -> tuple[dict[str, Tensor], dict[str, Any]] | None:
    """What save_state wrote, or None where there is nothing.

    A save that was cut short leaves its predecessor, which is taken then. Raises CheckpointError
    where shards are missing or damaged.
    """
    former = folder.with_name(folder.name + ".old")
    if not folder.is_dir() and former.is_dir():
        folder = former
    if not (folder / INDEX_FILE).is_file():
        return None
    try:
        index = json.loads((folder / INDEX_FILE).read_text(encoding="utf-8"))
        _require_format(index, folder)
        parts: dict[str, Tensor] = {}
        for number in range(index["shards"]):
            parts.update(load_file(folder / f"{number:02d}.safetensors", device=device))
        tensors = {name: _joined(parts, name, shape) for name, shape in index["shapes"].items()}
    except (SafetensorError, OSError, ValueError, KeyError, RuntimeError) as error:
        raise CheckpointError(
            f"the state of the run is damaged ({str(error).splitlines()[0]})",
            where=str(folder),
            expected="the shards that belong to its state.json",
            try_="another output folder, with --start for the weights",
        ) from error
    return tensors, dict(index["counters"])


def _require_format(index: Mapping[str, Any], folder: Path) -> None:
    if index.get("format") != FORMAT:
        raise CheckpointError(
            f"the state of a run of another version (format {index.get('format')!r})",
            where=str(folder / INDEX_FILE),
            expected=f"format {FORMAT}",
            try_="another output folder, with --start for the weights of its checkpoint",
        )


def _shards(tensors: Mapping[str, Tensor]) -> Iterable[dict[str, Tensor]]:
    """Parts of the tensors in their order, packed up to the limit."""
    shard: dict[str, Tensor] = {}
    filled = 0
    for name, part in _parts(tensors):
        size = part.numel() * part.element_size()
        if shard and filled + size > MAX_SHARD_BYTES - _HEADER_BYTES:
            yield shard
            shard, filled = {}, 0
        shard[name] = part
        filled += size
    if shard:
        yield shard


_HEADER_BYTES = 2**18
"""Room for the names and shapes in front of the data."""


def _parts(tensors: Mapping[str, Tensor]) -> Iterable[tuple[str, Tensor]]:
    for name, tensor in tensors.items():
        flat = tensor.detach().cpu().contiguous().reshape(-1)
        most = (MAX_SHARD_BYTES - _HEADER_BYTES) // max(flat.element_size(), 1)
        for number, part in enumerate(flat.split(most) if flat.numel() else [flat]):
            yield f"{name}#{number}", part.clone()


def _joined(parts: Mapping[str, Tensor], name: str, shape: list[int]) -> Tensor:
    pieces: list[Tensor] = []
    while f"{name}#{len(pieces)}" in parts:
        pieces.append(parts[f"{name}#{len(pieces)}"])
    return torch.cat(pieces).reshape(shape)
