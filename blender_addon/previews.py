"""Pictures in the panel: the plan, and the models that a piece can be swapped for."""

from __future__ import annotations

from pathlib import Path

import bpy
import bpy.utils.previews

from .core.commands import PICTURE_SUFFIXES


class _Shown:
    """What is loaded; Blender wants it back when the extension is disabled."""

    pictures: bpy.utils.previews.ImagePreviewCollection | None = None


def icon(picture: Path | None) -> int:
    """The icon of a picture file; 0 where there is none that can be shown."""
    if picture is None or picture.suffix.lower() not in PICTURE_SUFFIXES:
        return 0
    try:
        changed = picture.stat().st_mtime_ns
    except OSError:
        return 0
    if _Shown.pictures is None:
        return 0
    key = f"{picture}|{changed}"
    if key not in _Shown.pictures:
        _Shown.pictures.load(key, str(picture), "IMAGE")
    return int(_Shown.pictures[key].icon_id)


def pictures_folder() -> Path:
    """Where the pictures of models are kept: they stay the same from one session to the next."""
    return Path(bpy.utils.extension_path_user(__package__, path="models", create=True))


def register() -> None:
    """Makes room for pictures."""
    _Shown.pictures = bpy.utils.previews.new()


def unregister() -> None:
    """Gives the pictures back."""
    if _Shown.pictures is not None:
        bpy.utils.previews.remove(_Shown.pictures)
    _Shown.pictures = None
