"""The state of a training run as a folder of small files, so that it travels through narrow doors.

Machines with a GPU are often at hand for minutes, behind limits on how large a file may be.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save
from torch import Tensor

from chord_usd.base.errors import CheckpointError

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
    found: list[Tensor] = []
    while f"{name}#{len(found)}" in parts:
        found.append(parts[f"{name}#{len(found)}"])
    return torch.cat(found).reshape(shape)
