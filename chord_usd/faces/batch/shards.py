"""Houses and pictures as WebDataset shards: tar files whose members are grouped by key.

A house is a sample of its plan, layout and scene graph; a picture is one of all passes of a camera.
A key has no dots, since the first dot ends it. The same houses give the same bytes.
"""

from __future__ import annotations

import io
import tarfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.files import output_folder
from chord_usd.faces.batch.make import LAYOUT_FILE, PLAN_FILE, SCENE_FILE

SHARDS_FOLDER = "shards"
SHARD_BYTES = 512 * 2**20
"""A shard is closed once it holds this much."""

_OF_A_HOUSE = (LAYOUT_FILE, PLAN_FILE, SCENE_FILE)


def write_shards(
    rows: Iterable[Mapping[str, Any]], folder: Path, shard_bytes: int = SHARD_BYTES
) -> list[Path]:
    """Write the finished rows of an index (index.rows) into folder/shards, which is replaced.

    `houses-000000.tar` and following hold KEY.plan.png, KEY.layout.png and KEY.scene.json,
    `pictures-000000.tar` and following KEY.png, KEY.json and further passes, where KEY is the
    house, or the house and the camera. Raises OutputError.
    """
    done = [row for row in rows if row["status"] == "done"]
    with output_folder(folder / SHARDS_FOLDER, "renew") as shards:
        for kind in ("house", "picture"):
            samples = (_sample(row, folder) for row in done if row["kind"] == kind)
            _write(samples, shards, f"{kind}s", shard_bytes)
    return sorted((folder / SHARDS_FOLDER).glob("*.tar"))


def _sample(row: Mapping[str, Any], folder: Path) -> list[tuple[str, Path]]:
    """(member name, file) pairs."""
    house, camera = row["house"], row["camera"]
    if camera is None:
        return [(f"{house}.{name}", folder / house / name) for name in _OF_A_HOUSE]
    files = sorted(folder / file for file in row["files"])
    return [(f"{house}-{camera}{file.name.removeprefix(camera)}", file) for file in files]


def _write(
    samples: Iterator[list[tuple[str, Path]]], folder: Path, name: str, shard_bytes: int
) -> None:
    """Samples are never divided between shards."""
    shard: tarfile.TarFile | None = None
    count = 0
    for sample in samples:
        if shard is None or shard.offset >= shard_bytes:
            if shard:
                shard.close()
            shard = tarfile.open(folder / f"{name}-{count:06d}.tar", "w")  # noqa: SIM115
            count += 1
        for member, file in sample:
            # Nothing of the machine or the hour: no time, no owner.
            data = file.read_bytes()
            header = tarfile.TarInfo(member)
            header.size = len(data)
            shard.addfile(header, io.BytesIO(data))
    if shard:
        shard.close()
