"""What a checkpoint folder says of itself, read without torch."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from chord_usd.base.errors import CheckpointError
from chord_usd.base.runtime.checksums import check_file
from chord_usd.base.runtime.networks import WEIGHTS_FILE, content_hash
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.schedule import Step, Walk

CONFIG_FILE = "config.json"
FORMAT = 1
REMEDY = ("<train=plan2layout>", "<reinstall>")


@dataclass(frozen=True)
class Description:
    """What is known of a trained network."""

    config: LayoutConfig
    content_hash: str
    """First 16 hex digits of the SHA-256 of the weights file."""
    training: dict[str, Any] = field(default_factory=dict)
    """Steps, images, minutes, data; as the training run wrote it."""
    walk: Walk = ()
    """The default sampler's (schedule.walk_of); none in checkpoints of the paper's kind."""


def read_description(folder: Path) -> Description:
    """Reads a checkpoint folder's config.json and hashes its weights.

    Raises CheckpointError where a file is missing, damaged or of another version.
    """
    path = folder / CONFIG_FILE
    values = _read_values(folder)
    try:
        config = LayoutConfig.from_dict(values["network"])
        training = dict(values.get("training", {}))
        walk = tuple(Step(int(time), *map(float, rest)) for time, *rest in values.get("walk", ()))
    except CheckpointError as error:
        raise CheckpointError(
            error.what, where=str(path), expected=error.expected, try_=error.try_
        ) from error
    except (TypeError, ValueError, AttributeError) as error:
        raise describes_no_network(error, path) from error
    weights = folder / WEIGHTS_FILE
    if not weights.is_file():
        raise CheckpointError("weights are missing", where=str(weights), try_=REMEDY)
    check_file(path)
    return Description(config, content_hash(folder), training, walk)


def describes_no_network(error: Exception, path: Path) -> CheckpointError:
    """The error of a configuration that no network can be built from."""
    return CheckpointError(
        f"describes no network ({error})",
        where=str(path),
        expected="the config.json that belongs to the weights beside it",
        try_="copy the checkpoint again",
    )


def _read_values(folder: Path) -> dict[str, Any]:
    path = folder / CONFIG_FILE
    if not path.is_file():
        raise CheckpointError(
            "no checkpoint here",
            where=str(folder),
            expected=f"a folder with {CONFIG_FILE} and {WEIGHTS_FILE}",
            try_=REMEDY,
        )
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        version = values["format"]
        values["network"]
    except (ValueError, KeyError, TypeError, OSError, RecursionError) as error:
        raise CheckpointError(
            "the checkpoint's configuration is damaged",
            where=str(path),
            expected="JSON with format, network and training",
            try_="copy the checkpoint again",
        ) from error
    if version != FORMAT:
        raise CheckpointError(
            f"checkpoint format {version}",
            where=str(path),
            expected=f"format {FORMAT}",
            try_="the version of the program that wrote it",
        )
    return dict(values)
