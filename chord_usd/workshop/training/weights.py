"""State of a training run: a network, its moving average and the moments of Adam."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from torch import Tensor, nn

from chord_usd.workshop.training.eight_bits import pack, unpack
from chord_usd.workshop.training.processes import Processes
from chord_usd.workshop.training.training_state import load_state, save_state

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
