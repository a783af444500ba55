"""The button that makes an asset library of the furniture."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import bpy

from .core import commands, library
from .jobs import JobOperator
from .properties import fields
from .session import Finish, session


class ChordBuildLibrary(JobOperator, bpy.types.Operator):
    """Draw all furniture and show it in the asset browser; takes some minutes, beside Blender"""

    bl_idname = "chord.build_library"
    bl_label = "Build asset library"

    def job(self, context: bpy.types.Context) -> tuple[list[str], Finish]:
        """The command line that draws the models; a second Blender then makes assets of them."""
        chosen = bpy.path.abspath(fields(context).library_folder)
        folder = library.library_folder(Path(chosen) if chosen else Path.home() / library.NAME)
        folder.mkdir(parents=True, exist_ok=True)

        def make_assets(told_in: bpy.types.Context, _data: dict[str, Any]) -> None:
            command = library.command(bpy.app.binary_path, sys.executable, folder)
            session.start_command(told_in, command, _show_library)

        return commands.build_assets(folder / library.MODELS), make_assets


def _show_library(context: bpy.types.Context, data: dict[str, Any]) -> None:
    """Enter the library in Blender's preferences, once."""
    folder = str(data["folder"])
    libraries = context.preferences.filepaths.asset_libraries
    if not any(Path(bpy.path.abspath(entry.path)) == Path(folder) for entry in libraries):
        libraries.new(name=library.NAME, directory=folder)
        context.preferences.is_dirty = True
    fields(context).note = f"{data['assets']} models in the asset browser, under {library.NAME}"


register, unregister = bpy.utils.register_classes_factory((ChordBuildLibrary,))
