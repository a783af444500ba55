"""What happens to houses when Blender files are opened and saved."""

from __future__ import annotations

import shutil
from pathlib import Path

import bpy
from bpy.app.handlers import persistent

from .core.claim import LOCK
from .core.commands import house_folder
from .jobs import unsaved_folder
from .preferences import preferences
from .properties import SCENE_KEY
from .session import session


@persistent
def _before_load(*_: object) -> None:
    session.leave_file()


@persistent
def _before_save(path: str = "", *_: object) -> None:
    """Houses of a file without a name move beside it when it gets one."""
    if not path:
        return
    for scene in bpy.data.scenes:
        props = getattr(scene, SCENE_KEY)
        props.house = session.place_of(props.house)
        house = Path(props.house)
        if props.house and house.is_file() and house.is_relative_to(unsaved_folder()):
            wanted = house_folder(path, house.parent.name, unsaved_folder())
            folder = session.claims.take_new(wanted)
            try:
                _copy(house.parent, folder)
            except OSError as error:
                session.claims.drop_empty()
                props.error = f"The house stays in a temporary folder: {error}"
            else:
                session.moved[props.house] = str(folder / house.name)
                props.house = str(folder / house.name)


def _copy(house_folder: Path, folder: Path) -> None:
    """All of a house but its lock, which the new one has already."""
    ignored = shutil.ignore_patterns(LOCK)
    shutil.copytree(house_folder, folder, ignore=ignored, dirs_exist_ok=True)


def _ask_program() -> None:
    """A moment after the start: preferences cannot be read while the extension is enabled."""
    session.ask_ahead(preferences(bpy.context).program)


def register() -> None:
    """Listens to Blender's files."""
    bpy.app.handlers.load_pre.append(_before_load)
    bpy.app.handlers.save_pre.append(_before_save)
    bpy.app.timers.register(_ask_program, first_interval=0.5)


def unregister() -> None:
    """Listens no more, and stops what runs."""
    bpy.app.handlers.load_pre.remove(_before_load)
    bpy.app.handlers.save_pre.remove(_before_save)
    if bpy.app.timers.is_registered(_ask_program):
        bpy.app.timers.unregister(_ask_program)
    session.leave_file()
