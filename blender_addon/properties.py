"""What the panel remembers in the Blender file."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

import bpy

from .core.commands import MAX_STEPS, PASSES
from .core.tree import is_ceiling

SCENE_KEY = "chord_usd"
"""The scene's property that holds the panel's fields."""

PATH_KEY = "chord_usd_path"
"""Custom property of objects and collections: their USD path."""

MAX_SEED = 2**31 - 1


def _show_light(room: ChordRoom, context: bpy.types.Context) -> None:
    from .house import set_light

    set_light(context, room.name, room.light)


def _show_solo(_own: ChordScene, context: bpy.types.Context) -> None:
    from .house import show_rooms

    show_rooms(context)


def _show_ceilings(_own: ChordScene, context: bpy.types.Context) -> None:
    show_ceilings(context)


class ChordRoom(bpy.types.PropertyGroup):
    """A line of the rooms list; its name is the room's prim."""

    seed: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Seed", description="Another seed furnishes the room differently", min=0, max=MAX_SEED
    )
    light: bpy.props.FloatProperty(  # type: ignore[valid-type]
        name="Lamps",
        description="Brightness of the room's lamps",
        default=1.0,
        min=0.05,
        max=20.0,
        soft_max=4.0,
        update=_show_light,
    )


class ChordFinding(bpy.types.PropertyGroup):
    """A line of the certificate; its name is the text."""

    paths: bpy.props.StringProperty()  # type: ignore[valid-type]
    """USD paths, one a line."""


class ChordScene(bpy.types.PropertyGroup):
    """The panel's fields."""

    source: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="From",
        items=[
            ("PLAN", "Plan", "A floor plan: picture, page, drawing or CHOrD JSON"),
            ("TEXT", "Text", "A description in words: the rooms are planned"),
            ("OUTLINE", "Open plan", "Outer walls alone: they are divided into rooms"),
        ],
    )
    plan: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Plan", description="Floor plan", subtype="FILE_PATH"
    )
    outline: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Open plan",
        description="Drawing of outer walls with their doors and windows",
        subtype="FILE_PATH",
    )
    text: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Text",
        description="Rooms and floor area, such as: a two-bedroom flat with an open kitchen, "
        "about 70 m²",
    )
    style: bpy.props.StringProperty(name="Style")  # type: ignore[valid-type]
    seed: bpy.props.IntProperty(name="Seed", min=0, max=MAX_SEED)  # type: ignore[valid-type]
    steps: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Steps",
        description="Sampler steps; 0: as many as the model likes",
        min=0,
        max=MAX_STEPS,
    )
    tabletop: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Lay tables", description="Put things on tables, desks and worktops", default=True
    )
    assets: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Assets", description="Folder with meshes of your own", subtype="DIR_PATH"
    )
    house: bpy.props.StringProperty(name="House", subtype="FILE_PATH")  # type: ignore[valid-type]
    contents: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What the program says that the house holds, as JSON."""
    error: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    note: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """What the last job has to say."""
    planned: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What was understood and planned where the house was given no plan, in lines."""
    warnings: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What the program warned of when it made the house, one a line."""
    certificate: bpy.props.StringProperty()  # type: ignore[valid-type]
    rooms: bpy.props.CollectionProperty(type=ChordRoom)  # type: ignore[valid-type]
    room_index: bpy.props.IntProperty(update=_show_solo)  # type: ignore[valid-type]
    findings: bpy.props.CollectionProperty(type=ChordFinding)  # type: ignore[valid-type]
    finding_index: bpy.props.IntProperty()  # type: ignore[valid-type]
    hide_ceilings: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Hide ceilings", default=True, update=_show_ceilings
    )
    solo: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Solo", description="Show the chosen room alone", update=_show_solo
    )
    swap_path: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """The piece that models are offered for."""
    swap_models: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """Those models, as JSON."""
    all_rooms: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="All cameras", description="Else only that of the chosen room"
    )
    samples: bpy.props.IntProperty(name="Samples", default=128, min=1)  # type: ignore[valid-type]
    passes: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Passes",
        items=[(name, *told) for name, told in PASSES.items()],
        options={"ENUM_FLAG"},
        default={"rgb"},
    )
    render_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Pictures", default="//pictures", subtype="DIR_PATH"
    )
    farm_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Job", default="//farm job", subtype="DIR_PATH"
    )
    library_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Folder",
        description="For the furniture as a Blender asset library; empty: in your home folder",
        subtype="DIR_PATH",
    )


def fields(context: bpy.types.Context) -> ChordScene:
    """The panel's fields of this scene."""
    return getattr(context.scene, SCENE_KEY)


@lru_cache(maxsize=4)
def parsed(text: str) -> dict[str, Any]:
    """A field that holds JSON; the panel reads it with every redraw."""
    return dict(json.loads(text)) if text else {}


def chosen_room(context: bpy.types.Context) -> str:
    """Name of the room chosen in the list; empty where there is none."""
    own = fields(context)
    return own.rooms[own.room_index].name if 0 <= own.room_index < len(own.rooms) else ""


def show_ceilings(context: bpy.types.Context) -> None:
    """Bring the ceilings' visibility in line with the field."""
    hidden = fields(context).hide_ceilings
    for item in context.scene.objects:
        if is_ceiling(str(item.get(PATH_KEY, ""))):
            item.hide_set(hidden)


_register, _unregister = bpy.utils.register_classes_factory((ChordRoom, ChordFinding, ChordScene))


def register() -> None:
    """Makes the classes known and hangs the fields on scenes."""
    _register()
    setattr(bpy.types.Scene, SCENE_KEY, bpy.props.PointerProperty(type=ChordScene))


def unregister() -> None:
    """Takes them back."""
    delattr(bpy.types.Scene, SCENE_KEY)
    _unregister()
