"""Checkpoints on disk: config.json, fp16 safetensors and a model card, in one folder."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.checksums import checkpoint_files
from chord_usd.base.runtime.networks import WEIGHTS_FILE, read_weights
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.description import (
    CONFIG_FILE,
    FORMAT,
    REMEDY,
    Description,
    describes_no_network,
    read_description,
)
from chord_usd.line.layout.network import LayoutNetwork
from chord_usd.line.layout.schedule import Walk, walk_of


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A loaded network and what is known of it."""

    network: LayoutNetwork
    config: LayoutConfig
    content_hash: str = ""
    """First 16 hex digits of the SHA-256 of the weights file."""
    training: dict[str, Any] = field(default_factory=dict)
    """Steps, images, minutes, data; as the training run wrote it."""
    walk: Walk = ()
    """As Description has it; empty where that of the configuration is meant."""

    @property
    def description(self) -> Description:
        """The same without the network."""
        return Description(
            self.config, self.content_hash, self.training, self.walk or _walk(self.config)
        )


def _walk(config: LayoutConfig) -> Walk:
    if config.prediction != "sample":
        return ()
    return walk_of(config, config.default_sampler, config.default_steps)


def save_checkpoint(folder: Path, network: LayoutNetwork, training: dict[str, Any]) -> None:
    """Writes config.json, weights.safetensors (fp16) and hashes into folder, each atomically."""
    folder.mkdir(parents=True, exist_ok=True)
    with checkpoint_files(folder):
        state = {
            name: tensor.detach().cpu().to(torch.float16).contiguous()
            for name, tensor in network.state_dict().items()
        }
        partial = folder / (WEIGHTS_FILE + ".part")
        # Not save_file: it leaves a file that only its owner can read.
        partial.write_bytes(save(state))
        partial.replace(folder / WEIGHTS_FILE)
        config = network.config
        values: dict[str, Any] = {
            "format": FORMAT,
            "network": config.to_dict(),
            "training": training,
        }
        if walk := _walk(config):
            values["walk"] = walk
        partial = folder / (CONFIG_FILE + ".part")
        partial.write_text(json.dumps(values, indent=2) + "\n", encoding="utf-8")
        partial.replace(folder / CONFIG_FILE)


def load_checkpoint(folder: Path, device: str = "cpu") -> Checkpoint:
    """Reads a folder written by save_checkpoint; weights come back as fp32.

    Raises CheckpointError where a file is missing, damaged or of another version.
    """
    description = read_description(folder)
    try:
        network = LayoutNetwork(description.config)
    except (TypeError, ValueError, AttributeError, IndexError, RuntimeError) as error:
        raise describes_no_network(error, folder / CONFIG_FILE) from error
    weights = read_weights(folder / WEIGHTS_FILE, REMEDY)
    try:
        network.load_state_dict(
            {name: torch.from_numpy(value).float() for name, value in weights.items()}
        )
    except RuntimeError as error:
        raise CheckpointError(
            f"weights are damaged or of another version ({str(error).splitlines()[0]})",
            where=str(folder / WEIGHTS_FILE),
            expected="the safetensors file that belongs to the config.json beside it",
            try_="copy the checkpoint again",
        ) from error
    network.eval().requires_grad_(False)
    return Checkpoint(
        network.to(device),
        description.config,
        description.content_hash,
        description.training,
        description.walk,
    )
