"""What test scripts that run inside Blender share: the extension installed, buttons pressed.

Imported by the scripts in tests/blender, in a process of its own; never by pytest.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

MODULE = "bl_ext.user_default.chord_usd"


class Scenario:
    """A Blender with the extension, used as an artist does; told as JSON at the end."""

    def __init__(self) -> None:
        self.folder, self.zip_file, self.program = map(Path, sys.argv[1:4])
        os.environ["BLENDER_USER_RESOURCES"] = str(self.folder / "user")
        import bpy
        import mathutils

        self.bpy, self.math = bpy, mathutils
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.types = set(dir(bpy.types))
        bpy.ops.extensions.package_install_files(
            filepath=str(self.zip_file), repo="user_default", enable_on_install=True
        )
        self.told: dict[str, Any] = {}
        self.use(str(self.program))

    @property
    def own(self) -> Any:
        """The panel's fields."""
        return self.bpy.context.scene.chord_usd

    def part(self, name: str) -> Any:
        """A module of the extension."""
        from importlib import import_module

        return import_module(f"{MODULE}.{name}")

    def use(self, program: str) -> None:
        """Set the preference."""
        self.bpy.context.preferences.addons[MODULE].preferences.program = program

    def answer(self) -> str:
        """What a check of the program said."""
        return str(self.bpy.context.preferences.addons[MODULE].preferences.answer)

    def start(self, name: str, **options: Any) -> str:
        """Press a button; returns what is wrong with that."""
        try:
            getattr(self.bpy.ops.chord, name)(**options)
        except RuntimeError as error:
            return str(error)
        return ""

    def press(self, name: str, **options: Any) -> str:
        """Press a button and wait for all that follows; returns what went wrong."""
        wrong = self.start(name, **options)
        return wrong or self.wait()

    def wait(self) -> str:
        """Wait for the running job and those that follow it; returns what went wrong."""
        session = self.part("session").session
        while session.step(self.bpy.context):
            time.sleep(0.02)
        return str(self.own.error)

    def objects(self) -> dict[str, Any]:
        """The house's objects by USD path."""
        return dict(self.part("house").own_objects(self.bpy.context))

    def places(self) -> dict[str, list[list[float]]]:
        """Where the pieces stand, in the world."""
        self.bpy.context.view_layer.update()
        is_placed = self.part("core.tree").is_placed
        return {
            p: [list(r) for r in o.matrix_world] for p, o in self.objects().items() if is_placed(p)
        }

    def houses(self) -> list[str]:
        """What lies where houses of a file without a name go."""
        folder = self.part("jobs").unsaved_folder() / "chord-usd"
        return sorted(one.name for one in folder.iterdir()) if folder.is_dir() else []

    def choose_room(self, name: str) -> None:
        """Choose it in the list."""
        self.own.room_index = [room.name for room in self.own.rooms].index(name)

    def drawn(self) -> list[list[str]]:
        """What all panels draw now, a line for each call of the layout."""
        log: list[list[str]] = []
        for panel in self.part("panel").PANELS:
            if not hasattr(panel, "poll") or panel.poll(self.bpy.context):
                panel.draw(_Shown(log), self.bpy.context)
        return log

    def tree(self, collection: Any) -> dict[str, Any]:
        """Names of collections, nested."""
        return {c.name: self.tree(c) for c in collection.children if "proto" not in c.name}

    def disable(self) -> None:
        """Switch the extension off, and note what is left of it."""
        self.bpy.ops.preferences.addon_disable(module=MODULE)
        handlers = self.bpy.app.handlers
        self.told["left"] = [
            t for t in set(dir(self.bpy.types)) - self.types if "chord" in t.lower()
        ]
        self.told["field_left"] = hasattr(self.bpy.types.Scene, "chord_usd")
        self.told["handlers_left"] = [
            repr(one)
            for one in (*handlers.load_pre, *handlers.save_pre)
            if "chord_usd" in one.__module__
        ]

    def tell(self) -> None:
        """Hand over what was noted."""
        sys.stdout.write(f"RESULT{json.dumps(self.told)}\n")


class _Shown:
    """Stands in for a panel that is drawn."""

    def __init__(self, log: list[list[str]]) -> None:
        self.layout = _Layout(log)


class _Layout:
    """Stands in for a layout: writes down what is drawn, and refuses what a real one would."""

    def __init__(self, log: list[list[str]]) -> None:
        import bpy

        self.__dict__.update(log=log, bpy=bpy, rna=bpy.types.UILayout.bl_rna)

    def __getattr__(self, kind: str) -> Callable[..., Any]:
        parameters = [one for one in self.rna.functions[kind].parameters if not one.is_output]

        def draw(*args: Any, **options: Any) -> Any:
            given = {
                **dict(zip((one.identifier for one in parameters), args, strict=False)),
                **options,
            }
            for name, value in given.items():
                _accept(next(one for one in parameters if one.identifier == name), value)
            for data, field in (("data", "property"), ("dataptr", "propname")):
                if data in given:
                    assert given[field] in given[data].bl_rna.properties, given
            words = [one for one in args if isinstance(one, str)]
            self.log.append([kind, *words, *map(str, options.values())])
            if kind != "operator":
                return _Layout(self.log)
            name = given["operator"].split(".")[1]
            return _Options(getattr(self.bpy.ops.chord, name).get_rna_type().properties)

        return draw

    def __setattr__(self, name: str, value: Any) -> None:
        assert name in self.rna.properties, name


class _Options:
    """Stands in for the options of a button that is drawn."""

    def __init__(self, properties: Any) -> None:
        self.__dict__["properties"] = properties

    def __setattr__(self, name: str, value: Any) -> None:
        assert name in self.properties, name


def _accept(parameter: Any, value: Any) -> None:
    """Fails for a word that is none of an enumeration, such as an icon that does not exist."""
    if parameter.type == "ENUM" and not parameter.is_enum_flag:
        assert value in parameter.enum_items, (parameter.identifier, value)
