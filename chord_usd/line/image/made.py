"""What a picture was made from: the record by which a later run keeps it or makes it again."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from chord_usd import __version__
from chord_usd.base.errors import RenderError, reason_of
from chord_usd.base.runtime.files import hash_file
from chord_usd.base.runtime.stages import StageFiles
from chord_usd.base.scene.skies import sky_named
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.products import PASSES
from chord_usd.line.image.stage_cameras import StageCamera

_DIGITS = 9
"""Of a camera's numbers, in metres: processors differ in the last bits of a sine."""

_NAMED = 3
"""Missing files that a message names."""

_FOREIGN_SUFFIXES = (".mdl",)
"""Of materials that only other renderers read, and have on a search path."""


def missing_files(files: StageFiles) -> list[str]:
    """Asset paths of layers and pictures that a stage names and that are not there."""
    return [path for path in files.missing if not path.endswith(_FOREIGN_SUFFIXES)]


def require_files(stage: Path, files: StageFiles) -> None:
    """Raises RenderError with count and first names where a stage lacks files."""
    if missing := missing_files(files):
        raise RenderError(
            missing_words(missing),
            where=str(stage),
            expected="a stage with all its files",
            try_=("copies of them beside it", "<allow_missing>"),
        )


def missing_words(missing: list[str]) -> str:
    """Count and first names of missing files."""
    named = ", ".join(missing[:_NAMED]) + (", ..." if len(missing) > _NAMED else "")
    are = "file is" if len(missing) == 1 else "files are"
    return f"{len(missing)} {are} missing ({named})"


def stage_digest(files: StageFiles) -> str:
    """SHA-256 over the names and bytes of all layers, meshes and textures of a stage.

    Names count from the stage's folder, so a stage that moves keeps its digest. Raises RenderError
    for a file that cannot be read.
    """
    stage = files.layers[0]
    home = stage.parent
    digest = hashlib.sha256()
    for file in (stage, *sorted({*files.layers[1:], *files.others})):
        name = "" if file == stage else Path(os.path.relpath(file, home)).as_posix()
        digest.update(f"{name}\0{_hash(file)}\n".encode())
    for name in sorted(files.missing):
        digest.update(f"{name}\0missing\n".encode())
    return digest.hexdigest()


def _hash(file: Path) -> str:
    try:
        return hash_file(file)
    except OSError as error:
        raise RenderError(f"cannot be read ({reason_of(error)})", where=str(file)) from error


def settings_record(options: RenderOptions) -> dict[str, Any]:
    """What decides the pixels besides stage and camera; the same for all parts of a picture.

    Raises ChordError for a sky that there is none of.
    """
    width_px, height_px = options.resolution_px
    return {
        "lighting": options.lighting,
        "sky": _sky(options.sky),
        "roof": options.roof,
        "width_px": width_px,
        "height_px": height_px,
        "passes": [name for name in PASSES if name in options.passes],
        "quality": asdict(options.traced),
        "seed": options.seed,
        "exposure_ev": options.exposure_ev,
        "room_names": options.room_names,
        "parts": options.merge or options.part is not None,
        "engine": options.engine,
        "version": __version__,
        "blender": blender_version(),
    }


def picture_record(
    settings: dict[str, Any], stage_sha256: str, camera: StageCamera
) -> dict[str, Any]:
    """The record of a camera's picture, as JSON values, and `sha256` over all of it.

    settings: of settings_record. stage_sha256: of stage_digest. camera: framed for the picture.
    """
    record = json.loads(
        json.dumps({"stage_sha256": stage_sha256, "camera": _rounded(asdict(camera)), **settings})
    )
    text = json.dumps(record, sort_keys=True)
    return {**record, "sha256": hashlib.sha256(text.encode()).hexdigest()}


def blender_version() -> str:
    """Of the wheel that renders; empty where it is not installed as one."""
    try:
        return version("bpy")
    except PackageNotFoundError:
        return ""


def _sky(name: str) -> str:
    """A sky's name; of a file, its content, since workers have it at other paths."""
    file = sky_named(name).file if name else None
    return _hash(file) if file else name


def _rounded(value: Any) -> Any:
    if isinstance(value, float):
        return round(value, _DIGITS) + 0.0
    if isinstance(value, dict):
        return {key: _rounded(part) for key, part in value.items()}
    return [_rounded(part) for part in value] if isinstance(value, tuple) else value
