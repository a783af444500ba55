"""What the panel remembers in the Blender file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import bpy

from .core.commands import PASSES
from .core.options import FOLDERS, ROWS, usual

SCENE_KEY = "chord_usd"
"""The scene's property that holds the panel's fields."""

PART_KEY = "chord_usd_part"
"""Custom property of the house's collections: the part of it that they hold, such as a room.

Empty for what only instances show."""

MAX_SEED = 2**31 - 1


def _show_light(room: ChordRoom, context: bpy.types.Context) -> None:
    from .house import set_light

    set_light(context, room.name, room.light)


def _show_solo(_props: ChordScene, context: bpy.types.Context) -> None:
    from .house import show_rooms

    show_rooms(context)


def _choose_room(props: ChordScene, context: bpy.types.Context) -> None:
    props.render_room = chosen_room(context)
    _show_solo(props, context)


def _show_ceilings(_props: ChordScene, context: bpy.types.Context) -> None:
    from .house import show_ceilings

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


class ChordObject(bpy.types.PropertyGroup):
    """An object of the house. It is known by a pointer: names change, and copies look the same."""

    path: bpy.props.StringProperty()  # type: ignore[valid-type]
    """Its USD path."""
    object: bpy.props.PointerProperty(type=bpy.types.Object)  # type: ignore[valid-type]


class ChordFinding(bpy.types.PropertyGroup):
    """A line of the certificate; its name is the text."""

    paths: bpy.props.StringProperty()  # type: ignore[valid-type]
    """USD paths, one a line."""
    is_planning: bpy.props.BoolProperty()  # type: ignore[valid-type]
    """Whether it is a published planning number that is missed, and no fault."""


class ChordChange(bpy.types.PropertyGroup):
    """A line of the house's history; its name is the text."""

    number: bpy.props.IntProperty()  # type: ignore[valid-type]
    """Of the change, as the program counts."""


def _property(row: Mapping[str, Any]) -> Any:
    """A field for a row of the option table."""
    facts: dict[str, Any] = {"name": row["label"], "description": row["help"]}
    if row["name"] == FOLDERS:
        return bpy.props.StringProperty(subtype="DIR_PATH", **facts)
    if row["kind"] == "number":
        is_whole = isinstance(row["least"], int)
        kind = bpy.props.IntProperty if is_whole else bpy.props.FloatProperty
        more = {} if is_whole else {"precision": 4, "step": 0.01}
        return kind(
            default=usual(row), min=min(usual(row), row["least"]), max=row["most"], **more, **facts
        )
    if row["kind"] == "choice":
        items = [(name or "NONE", name or "Usual", row["help"]) for name in row["choices"]]
        return bpy.props.EnumProperty(items=items, default=usual(row) or "NONE", **facts)
    kind = bpy.props.BoolProperty if row["kind"] == "check" else bpy.props.StringProperty
    return kind(default=row["default"], **facts)


class ChordScene(bpy.types.PropertyGroup):
    """The panel's fields; the option table's fields follow below."""

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
    house: bpy.props.StringProperty(name="House", subtype="FILE_PATH")  # type: ignore[valid-type]
    contents: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What the program says that the house holds, as JSON."""
    objects: bpy.props.CollectionProperty(type=ChordObject)  # type: ignore[valid-type]
    """What came in with the house, wherever it was put since."""
    placed: bpy.props.StringProperty()  # type: ignore[valid-type]
    """Where the house itself has its pieces, as JSON: a removed object remembers nothing."""
    came_with: bpy.props.StringProperty()  # type: ignore[valid-type]
    """The changes that the house came in with, as JSON."""
    revision: bpy.props.StringProperty()  # type: ignore[valid-type]
    """Which state of the house is shown. It is undone with the scene."""
    error: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    note: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """What the last job has to say."""
    planned: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What was understood and planned where the house was given no plan, in lines."""
    warnings: bpy.props.StringProperty()  # type: ignore[valid-type]
    """What the program warned of when it made the house, one a line."""
    certificate: bpy.props.StringProperty()  # type: ignore[valid-type]
    rooms: bpy.props.CollectionProperty(type=ChordRoom)  # type: ignore[valid-type]
    room_index: bpy.props.IntProperty(update=_choose_room)  # type: ignore[valid-type]
    findings: bpy.props.CollectionProperty(type=ChordFinding)  # type: ignore[valid-type]
    finding_index: bpy.props.IntProperty()  # type: ignore[valid-type]
    past: bpy.props.CollectionProperty(type=ChordChange)  # type: ignore[valid-type]
    """What was done to the house, the latest first."""
    past_index: bpy.props.IntProperty()  # type: ignore[valid-type]
    can_redo: bpy.props.BoolProperty()  # type: ignore[valid-type]
    hide_ceilings: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Hide ceilings", default=True, update=_show_ceilings
    )
    show_roof: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Show roof",
        description="In the scene; whether pictures show it, the house's look says",
        update=_show_solo,
    )
    wanted: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="With", description="Pieces that a refurnished room must hold, in words"
    )
    unwanted: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Without", description="Pieces that a refurnished room must not hold, in words"
    )
    sentence: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Change", description="A change to the house, in words"
    )
    understood: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """What the program takes a sentence to mean, in lines."""
    understood_of: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """That sentence."""
    solo: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Solo", description="Show the chosen room alone", update=_show_solo
    )
    storey: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Up to storey",
        description="Hide the storeys above this one, counted from the lowest; 0: show all",
        min=0,
        max=12,
        update=_show_solo,
    )
    swap_path: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """The piece that models are offered for."""
    swap_models: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    """Those models, as JSON."""
    all_rooms: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="All cameras", description="Else only that of one room"
    )
    render_room: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Room", description="The room to render"
    )
    samples: bpy.props.IntProperty(name="Samples", default=128, min=1)  # type: ignore[valid-type]
    passes: bpy.props.EnumProperty(  # type: ignore[valid-type]
        name="Passes",
        items=[(name, *labels) for name, labels in PASSES.items()],
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


ChordScene.__annotations__ |= {row["name"]: _property(row) for row in ROWS}


def chosen_options(context: bpy.types.Context) -> dict[str, Any]:
    """Values of the option table's fields, by name; a folder as its full path."""
    props = fields(context)
    values = {row["name"]: getattr(props, row["name"]) for row in ROWS}
    values = {name: "" if value == "NONE" else value for name, value in values.items()}
    return values | {FOLDERS: bpy.path.abspath(values[FOLDERS])}


def fields(context: bpy.types.Context) -> ChordScene:
    """The panel's fields of this scene."""
    return getattr(context.scene, SCENE_KEY)


@lru_cache(maxsize=4)
def parsed(text: str) -> dict[str, Any]:
    """A field that holds JSON; the panel reads it with every redraw."""
    return dict(json.loads(text)) if text else {}


def chosen_room(context: bpy.types.Context) -> str:
    """Name of the room chosen in the list; empty where there is none."""
    props = fields(context)
    return props.rooms[props.room_index].name if 0 <= props.room_index < len(props.rooms) else ""


_register, _unregister = bpy.utils.register_classes_factory(
    (ChordRoom, ChordObject, ChordFinding, ChordChange, ChordScene)
)


def register() -> None:
    """Makes the classes known and hangs the fields on scenes."""
    _register()
    setattr(bpy.types.Scene, SCENE_KEY, bpy.props.PointerProperty(type=ChordScene))


def unregister() -> None:
    """Takes them back."""
    delattr(bpy.types.Scene, SCENE_KEY)
    _unregister()
