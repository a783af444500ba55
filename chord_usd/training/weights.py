"""What a training run must not lose: a network, its moving average and what Adam keeps of it."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Generic, TypeVar

import torch
from torch import Tensor, nn

from chord_usd.training.training_state import load_state, save_state

_MOMENTS = ("exp_avg", "exp_avg_sq")
"""What Adam keeps of every weight."""

NetworkT = TypeVar("NetworkT", bound=nn.Module)


def warm_and_cool(
    steps: int, warmup_steps: int, spent: float, cooldown_share: float, end: float
) -> float:
    """What a learning rate is multiplied by: up to 1 over a run's first steps, and down to end over
    the last share of its budget.

    spent: share of the budget, in [0, 1].
    """
    warm = min(1.0, (steps + 1) / max(warmup_steps, 1))
    into_cooldown = max(0.0, spent - 1.0 + cooldown_share) / cooldown_share
    return warm * (1.0 - (1.0 - end) * into_cooldown)


class Weights(Generic[NetworkT]):
    """A network in training."""

    def __init__(
        self, network: NetworkT, learning_rate: float, weight_decay: float, decay: float
    ) -> None:
        self.network = network
        self.decay = decay
        self.average = copy.deepcopy(network).eval()
        self.average.requires_grad_(False)
        self.optimiser = torch.optim.AdamW(
            self._learning().values(), learning_rate, weight_decay=weight_decay
        )

    def _learning(self) -> dict[str, nn.Parameter]:
        """By name: what is not frozen."""
        return {name: p for name, p in self.network.named_parameters() if p.requires_grad}

    def step(self, loss: Tensor, learning_rate: float, clip: float, steps_before: int) -> None:
        """One step down the gradient of a loss, gradients clipped to a norm; then the average."""
        for group in self.optimiser.param_groups:
            group["lr"] = learning_rate
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(self.network.parameters(), clip)
        self.optimiser.step()
        self._update_average(steps_before + 1)

    @torch.no_grad()
    def _update_average(self, steps: int) -> None:
        # The average of the first steps would remember the random initialisation for too long.
        decay = min(self.decay, (1.0 + steps) / (10.0 + steps))
        averages = [parameter.data for parameter in self.average.parameters()]
        current = [parameter.data for parameter in self.network.parameters()]
        torch._foreach_lerp_(averages, current, 1.0 - decay)

    def save(self, folder: Path, counters: Mapping[str, Any]) -> None:
        """Write all of it and the counters into a folder that load reads (training_state.py).

        Only the weights themselves are kept in full: half the digits do for averages and moments.
        """
        tensors = {f"network.{name}": t for name, t in self.network.state_dict().items()}
        for name, average in self.average.state_dict().items():
            tensors[f"average.{name}"] = average.to(torch.float16)
        steps = 0.0
        for name, parameter in self._learning().items():
            own = self.optimiser.state[parameter]
            steps = float(own["step"])
            tensors |= {f"{key}.{name}": own[key].to(torch.bfloat16) for key in _MOMENTS}
        save_state(folder, tensors, {**counters, "optimiser_steps": steps})

    def load(self, folder: Path, device: str) -> dict[str, Any] | None:
        """Take up what save wrote and return its counters; None where there is nothing.

        Raises CheckpointError where it is damaged.
        """
        found = load_state(folder, device)
        if found is None:
            return None
        tensors, counters = found
        self.network.load_state_dict(_below(tensors, "network"))
        self.average.load_state_dict(_below(tensors, "average"))
        for name, parameter in self._learning().items():
            self.optimiser.state[parameter] = {
                "step": torch.tensor(float(counters["optimiser_steps"])),
                **{key: tensors[f"{key}.{name}"].to(parameter) for key in _MOMENTS},
            }
        return counters


def _below(tensors: Mapping[str, Tensor], prefix: str) -> dict[str, Tensor]:
    """The tensors whose names begin so, without the prefix, in float32."""
    return {
        name.removeprefix(f"{prefix}."): tensor.float()
        for name, tensor in tensors.items()
        if name.startswith(f"{prefix}.")
    }
