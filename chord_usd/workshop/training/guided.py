"""Training toward a guided estimate: what a network says, away from what it said too early.

A network that is guided away from a worse version of itself makes fewer of the mistakes that both
make (autoguidance; Karras et al., Guiding a diffusion model with a bad version of itself, 2024),
but is asked twice at each step. Learning the guided estimate instead (Meng et al., On distillation
of guided diffusion models, 2023) costs that once.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import torch
from torch import Tensor

from chord_usd.line.layout.checkpoint import load_checkpoint
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.workshop.training.stream import Batch
from chord_usd.workshop.training.trainer import LayoutTrainer, PlanTensors, TrainingConfig

GUIDED_TRAINING = TrainingConfig(learning_rate=2e-4, cooldown_share=0.6, ema_decay=0.99)
"""A short run from a network that is nearly there: its average must follow soon."""

_LEAST_CHANCE = 0.01
"""What the teacher believes less is never raised: the ratio of two chances near zero is noise, and
would be painted as specks on bare floor."""


class GuidedTrainer(LayoutTrainer):
    """Teaches categories as a teacher guided by a weaker network says them; fronts from data."""

    def __init__(
        self,
        network_config: LayoutConfig,
        config: TrainingConfig,
        folder: Path,
        teacher: Path,
        guide: Path,
        guidance: float,
    ) -> None:
        """teacher, guide: checkpoint folders, of which the guide is the less trained one.

        guidance: by how much the teacher's difference from the guide is multiplied; 1 is the
        teacher alone. Raises CheckpointError for an unusable folder.
        """
        leaders = [
            load_checkpoint(checkpoint, config.device).network for checkpoint in (teacher, guide)
        ]
        # What they are not shown they say nothing of.
        draft = all(leader.config.draft for leader in leaders)
        super().__init__(replace(network_config, draft=draft), config, folder)
        self._teacher, self._guide = leaders
        self._guidance = guidance

    @torch.no_grad()
    def _wanted(self, batch: Batch, noisy: Tensor, times: Tensor, plan: PlanTensors) -> Tensor:
        """(B, class_count, H, W) chances of the categories, by the guided teacher."""
        teacher, guide = (
            self._said(network, batch, noisy, times, plan)
            for network in (self._teacher, self._guide)
        )
        lead = (self._guidance - 1.0) * (teacher - guide)
        believed = teacher > math.log(_LEAST_CHANCE)
        return (teacher + torch.where(believed, lead, lead.clamp(max=0.0))).softmax(dim=1)

    def _said(
        self, network: LayoutNetwork, batch: Batch, noisy: Tensor, times: Tensor, plan: PlanTensors
    ) -> Tensor:
        """Log chances of the categories, by a network that may code fronts otherwise."""
        labels, front = batch["labels"], batch["front"]
        alphas = self.scheduler.alphas_cumprod.to(times.device)[times, None, None, None]
        recoded = network.encode(labels, front) - self.network.encode(labels, front)
        output = network(noisy + alphas.sqrt() * recoded, times, *plan)
        return output[:, : self.traits.class_count].float().log_softmax(dim=1)
