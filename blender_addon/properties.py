"""What the panel remembers in the Blender file."""

from __future__ import annotations

import bpy

SCENE_KEY = "chord_usd"
"""The scene's property that holds the panel's fields."""

PATH_KEY = "chord_usd_path"
"""Custom property of objects and collections: their USD path."""

MAX_SEED = 2**31 - 1


class ChordRoom(bpy.types.PropertyGroup):
    """A line of the rooms list; its name is the room's prim."""

    seed: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Seed", description="Another seed furnishes the room differently", min=0, max=MAX_SEED
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
            ("PLAN", "Plan", "A floor plan picture, or CHOrD JSON"),
            ("TEXT", "Text", "A description in words"),
            ("OUTLINE", "Outline", "A picture of the outer walls alone"),
        ],
    )
    plan: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Plan", description="Floor plan picture", subtype="FILE_PATH"
    )
    text: bpy.props.StringProperty(name="Text")  # type: ignore[valid-type]
    seed: bpy.props.IntProperty(name="Seed", min=0, max=MAX_SEED)  # type: ignore[valid-type]
    steps: bpy.props.IntProperty(  # type: ignore[valid-type]
        name="Steps", description="Sampler steps; 0: as many as the model likes", min=0, max=1000
    )
    assets: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Assets", description="Folder with meshes of your own", subtype="DIR_PATH"
    )
    house: bpy.props.StringProperty(name="House", subtype="FILE_PATH")  # type: ignore[valid-type]
    error: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]
    certificate: bpy.props.StringProperty()  # type: ignore[valid-type]
    rooms: bpy.props.CollectionProperty(type=ChordRoom)  # type: ignore[valid-type]
    room_index: bpy.props.IntProperty()  # type: ignore[valid-type]
    findings: bpy.props.CollectionProperty(type=ChordFinding)  # type: ignore[valid-type]
    finding_index: bpy.props.IntProperty()  # type: ignore[valid-type]
    hide_ceilings: bpy.props.BoolProperty(  # type: ignore[valid-type]
        name="Hide ceilings", default=True, update=lambda self, context: show_ceilings(context)
    )
    samples: bpy.props.IntProperty(name="Samples", default=128, min=1)  # type: ignore[valid-type]
    render_folder: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="Pictures", default="//pictures", subtype="DIR_PATH"
    )


def fields(context: bpy.types.Context) -> ChordScene:
    """The panel's fields of this scene."""
    return getattr(context.scene, SCENE_KEY)


def show_ceilings(context: bpy.types.Context) -> None:
    """Bring the ceilings' visibility in line with the field."""
    from .core.tree import is_ceiling

    hidden = fields(context).hide_ceilings
    for item in context.scene.objects:
        if is_ceiling(str(item.get(PATH_KEY, ""))):
            item.hide_set(hidden)


_CLASSES = (ChordRoom, ChordFinding, ChordScene)


def register() -> None:
    """Makes the classes known and hangs the fields on scenes."""
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    setattr(bpy.types.Scene, SCENE_KEY, bpy.props.PointerProperty(type=ChordScene))


def unregister() -> None:
    """Takes them back."""
    delattr(bpy.types.Scene, SCENE_KEY)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
