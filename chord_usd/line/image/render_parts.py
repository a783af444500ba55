"""Parts of pictures: one band of rows, one block of samples each, in one checked file.

A part is rendered without denoising and without adaptive sampling, which look beyond it, so parts
fit together exactly: bands are cut from the same picture, equal blocks average to it. The first
block of a band also holds depth, normals and numbers, which need no averaging.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.files import deliver
from chord_usd.line.image.exr import Channels, PixelArray, colour_channels, read_exr, write_exr
from chord_usd.line.image.job import Part
from chord_usd.line.image.stage_cameras import StageCamera
from chord_usd.line.image.takes import Take

_NOTE = "chordPart"
"""Header attribute: how the part was made, as JSON."""

_NAME = re.compile(r"(.+)\.tile-(\d+)-of-(\d+)\.block-(\d+)-of-(\d+)\.exr")


@dataclass(frozen=True, eq=False)
class _Found:
    """A part that was read."""

    part: Part
    channels: Channels
    made: dict[str, Any]
    exposure_ev: float


def part_file(folder: Path, camera: str, part: Part) -> Path:
    """Where a part of a camera's picture goes."""
    tile, block = part.tile, part.block
    return folder / (f"{camera}.tile-{tile[0]}-of-{tile[1]}.block-{block[0]}-of-{block[1]}.exr")


def write_part(take: Take, folder: Path, part: Part, made: dict[str, Any]) -> Path:
    """Write a take as a part. Raises OutputError; then there is no file."""
    target = part_file(folder, take.view.name, part)
    channels = _channels(take)
    note = {"made": made, "exposure_ev": take.exposure_ev, "sha256": _digest(channels)}
    with deliver() as delivery:
        write_exr(
            delivery.place(target, asked=False, ours=_is_part), channels, {_NOTE: json.dumps(note)}
        )
    return target


def _is_part(path: Path) -> bool:
    """Whether it is a part, a damaged one too: nobody works on these by hand."""
    try:
        return _NOTE in read_exr(path)[1]
    except (OSError, RuntimeError, ValueError):
        return False


def is_finished_part(folder: Path, camera: str, part: Part, made: dict[str, Any]) -> bool:
    """Whether a part is there, whole, and made in this way."""
    try:
        return _read_part(part_file(folder, camera, part), part).made == made
    except RenderError:
        return False


def merge_parts(folder: Path, view: StageCamera, made: dict[str, Any]) -> Take:
    """Put a camera's parts together.

    Raises RenderError for a part that is missing, damaged or made in another way.
    """
    bands = []
    for tile in range((whole := _division(folder, view.name)).tile[1]):
        blocks = []
        for block in range(whole.block[1]):
            part = Part((tile, whole.tile[1]), (block, whole.block[1]))
            path = part_file(folder, view.name, part)
            loaded = _read_part(path, part)
            if loaded.made != made:
                raise RenderError(
                    f"was made with other options ({_differences(loaded.made, made)})",
                    where=str(path),
                    expected="parts of the picture that is asked for",
                    try_="the options the parts were rendered with, or render the part again",
                )
            blocks.append(loaded)
        bands.append(_average(blocks))
    channels = {name: np.concatenate([band[name] for band in bands]) for name in bands[0]}
    return _take(view, loaded.exposure_ev, channels)


def _division(folder: Path, camera: str) -> Part:
    """The last part of a camera's picture, by the names of those that are there."""
    counts = set()
    for path in folder.glob(f"{camera}.tile-*.exr"):
        match = _NAME.fullmatch(path.name)
        if match and match[1] == camera:
            counts.add((int(match[3]), int(match[5])))
    if len(counts) != 1:
        raise RenderError(
            "has parts of more than one division" if counts else f"has no parts of '{camera}'",
            where=str(folder),
            expected="one set of tiles and sample blocks",
            try_="<tile=0/2> and <tile=1/2> first" if not counts else "another folder",
        )
    ((tiles, blocks),) = counts
    return Part((tiles - 1, tiles), (blocks - 1, blocks))


def _read_part(path: Path, part: Part) -> _Found:
    """Raises RenderError unless the part is whole and its pixels are those that were written."""
    try:
        if not path.exists():  # OpenEXR would complain on standard error too
            raise FileNotFoundError(path)
        channels, header = read_exr(path)
        note = json.loads(str(header[_NOTE]))
        whole = note["sha256"] == _digest(channels)
        loaded = _Found(part, channels, note["made"], float(note["exposure_ev"]))
    except (OSError, KeyError, ValueError, TypeError) as error:
        what = "is damaged" if path.exists() else "is missing"
        raise RenderError(
            what,
            where=str(path),
            expected="a part of a picture",
            try_=f"<tile={part.tile[0]}/{part.tile[1]}> "
            f"<sample_block={part.block[0]}/{part.block[1]}>",
        ) from error
    if not whole:
        raise RenderError("is damaged", where=str(path), try_="render this part again")
    return loaded


def _average(blocks: Sequence[_Found]) -> Channels:
    """Light is the mean of equal blocks; data come from the first."""
    light = ("R", "G", "B", "A")
    return {
        name: np.mean([block.channels[name].astype(np.float64) for block in blocks], axis=0).astype(
            np.float32
        )
        if name in light
        else values
        for name, values in blocks[0].channels.items()
    }


def _channels(take: Take) -> Channels:
    channels: Channels = {}
    if take.colour is not None:
        channels |= colour_channels(take.colour)
    if take.depth_m is not None:
        channels["Z"] = take.depth_m
    if take.normal is not None:
        channels |= {f"N.{axis}": take.normal[..., at] for at, axis in enumerate("XYZ")}
    if take.numbers is not None:
        channels["id"] = take.numbers
    return channels


def _take(view: StageCamera, exposure_ev: float, channels: Channels) -> Take:
    def stacked(*names: str) -> PixelArray | None:
        there = [channels[name] for name in names if name in channels]
        return np.stack(there, axis=-1) if there else None

    return Take(
        view,
        exposure_ev,
        colour=stacked("R", "G", "B", "A"),
        depth_m=channels.get("Z"),
        normal=stacked("N.X", "N.Y", "N.Z"),
        numbers=channels.get("id"),
    )


def _digest(channels: Channels) -> str:
    digest = hashlib.sha256()
    for name in sorted(channels):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(channels[name], dtype=np.float32).tobytes())
    return digest.hexdigest()


def _differences(actual: dict[str, Any], wanted: dict[str, Any]) -> str:
    keys = [key for key in sorted({*actual, *wanted}) if actual.get(key) != wanted.get(key)]
    return ", ".join(f"{key} {actual.get(key)}" for key in keys)
