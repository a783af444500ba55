"""Checkpoints on disk: config.json, fp16 safetensors and a model card, in one folder."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save

from chord_usd.errors import CheckpointError
from chord_usd.layout.config import LayoutConfig
from chord_usd.layout.network import LayoutNetwork

CONFIG_FILE = "config.json"
WEIGHTS_FILE = "weights.safetensors"
FORMAT = 1


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """A loaded network and what is known of it."""

    network: LayoutNetwork
    config: LayoutConfig
    content_hash: str
    """First 16 hex digits of the SHA-256 of the weights file."""
    training: dict[str, Any]
    """Steps, images, minutes, data; as the training run wrote it."""


def save_checkpoint(folder: Path, network: LayoutNetwork, training: dict[str, Any]) -> None:
    """Writes config.json and weights.safetensors (fp16) into folder, each atomically."""
    folder.mkdir(parents=True, exist_ok=True)
    state = {
        name: tensor.detach().cpu().to(torch.float16).contiguous()
        for name, tensor in network.state_dict().items()
    }
    partial = folder / (WEIGHTS_FILE + ".part")
    # Not save_file: it leaves a file that only its owner can read.
    partial.write_bytes(save(state))
    partial.replace(folder / WEIGHTS_FILE)
    text = json.dumps(
        {"format": FORMAT, "network": network.config.to_dict(), "training": training}, indent=2
    )
    partial = folder / (CONFIG_FILE + ".part")
    partial.write_text(text + "\n", encoding="utf-8")
    partial.replace(folder / CONFIG_FILE)


def load_checkpoint(folder: Path, device: str = "cpu") -> Checkpoint:
    """Reads a folder written by save_checkpoint; weights come back as fp32.

    Raises CheckpointError where a file is missing, damaged or of another version.
    """
    description = _read_description(folder / CONFIG_FILE)
    weights_path = folder / WEIGHTS_FILE
    if not weights_path.is_file():
        raise CheckpointError(
            "weights are missing",
            where=str(weights_path),
            try_="chord-usd train plan2layout, or reinstall chord-usd",
        )
    network = _build(description["network"], folder / CONFIG_FILE)
    config = network.config
    try:
        state = load_file(weights_path)
        network.load_state_dict({name: tensor.float() for name, tensor in state.items()})
    except (SafetensorError, RuntimeError, OSError) as error:
        raise CheckpointError(
            f"weights are damaged or of another version ({str(error).splitlines()[0]})",
            where=str(weights_path),
            expected="the safetensors file that belongs to the config.json beside it",
            try_="copy the checkpoint again",
        ) from error
    network.eval().requires_grad_(False)
    digest = hashlib.sha256(weights_path.read_bytes()).hexdigest()[:16]
    return Checkpoint(network.to(device), config, digest, dict(description.get("training", {})))


def _build(values: Any, path: Path) -> LayoutNetwork:
    """The network of a configuration, whatever someone has written there."""
    try:
        return LayoutNetwork(LayoutConfig.from_dict(values))
    except CheckpointError as error:
        raise CheckpointError(
            error.what, where=str(path), expected=error.expected, try_=error.try_
        ) from error
    except (TypeError, ValueError, AttributeError, IndexError, RuntimeError) as error:
        raise CheckpointError(
            f"describes no network ({error})",
            where=str(path),
            expected="the config.json that belongs to the weights beside it",
            try_="copy the checkpoint again",
        ) from error


def _read_description(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise CheckpointError(
            "no checkpoint here",
            where=str(path.parent),
            expected=f"a folder with {CONFIG_FILE} and {WEIGHTS_FILE}",
            try_="chord-usd train plan2layout, or reinstall chord-usd",
        )
    try:
        description = json.loads(path.read_text(encoding="utf-8"))
        found = description["format"]
        description["network"]
    except (ValueError, KeyError, TypeError, UnicodeDecodeError) as error:
        raise CheckpointError(
            "the checkpoint's configuration is damaged",
            where=str(path),
            expected="JSON with format, network and training",
            try_="copy the checkpoint again",
        ) from error
    if found != FORMAT:
        raise CheckpointError(
            f"checkpoint format {found}",
            where=str(path),
            expected=f"format {FORMAT}",
            try_="the chord-usd version that wrote it",
        )
    return dict(description)
