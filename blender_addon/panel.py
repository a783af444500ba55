"""The sidebar panel: draws the state and decides nothing."""

from __future__ import annotations

import bpy

from .core.state import panel_state, wrapped
from .properties import fields
from .session import session

LINE_LETTERS = 42
"""Letters that fit a line of the sidebar."""


class ChordPanel(bpy.types.Panel):
    """CHOrD in the sidebar of the 3-D view."""

    bl_idname = "VIEW3D_PT_chord"
    bl_label = "CHOrD"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "CHOrD"

    def draw(self, context: bpy.types.Context) -> None:
        """The whole panel."""
        own = fields(context)
        state = panel_state(session.job, own.house, own.error)
        _draw_source(self.layout, own, state.can_start)
        if state.phase == "RUNNING":
            self.layout.progress(factor=state.share, text=state.message)
            self.layout.operator("chord.cancel", icon="CANCEL")
        if state.phase == "FAILED":
            box = self.layout.box()
            for number, line in enumerate(wrapped(state.message, LINE_LETTERS)):
                box.label(text=line, icon="NONE" if number else "ERROR")
        if own.rooms:
            _draw_rooms(self.layout, own, state.can_start)
            _draw_certificate(self.layout, own, state.can_start)
            _draw_render(self.layout, own, state.can_start)


def _draw_source(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, free: bool) -> None:
    column = layout.column()
    column.enabled = free
    column.row().prop(own, "source", expand=True)
    column.prop(own, "text" if own.source == "TEXT" else "plan", text="")
    row = column.row(align=True)
    row.prop(own, "seed")
    row.operator("chord.dice", text="", icon="FILE_REFRESH")
    column.prop(own, "steps")
    column.prop(own, "assets")
    column.operator("chord.generate", icon="HOME")


def _draw_rooms(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, free: bool) -> None:
    box = layout.box()
    box.template_list("UI_UL_list", "chord_rooms", own, "rooms", own, "room_index", rows=4)
    row = box.row(align=True)
    row.operator("chord.frame_room", icon="VIEWZOOM")
    start = row.row(align=True)
    start.enabled = free
    start.operator("chord.regenerate", icon="FILE_REFRESH")
    box.prop(own, "hide_ceilings")
    box.operator("chord.save_edits", icon="FILE_TICK")


def _draw_certificate(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, free: bool) -> None:
    box = layout.box()
    row = box.row()
    row.label(text=own.certificate or "Not checked yet")
    start = row.row()
    start.enabled = free
    start.operator("chord.check_house", icon="CHECKMARK")
    for index, finding in enumerate(own.findings):
        box.operator("chord.show_finding", text=finding.name, icon="ERROR").index = index


def _draw_render(layout: bpy.types.UILayout, own: bpy.types.PropertyGroup, free: bool) -> None:
    box = layout.box()
    box.prop(own, "samples")
    box.prop(own, "render_folder")
    start = box.row()
    start.enabled = free
    start.operator("chord.render", icon="RENDER_STILL")


def register() -> None:
    """Makes the panel known."""
    bpy.utils.register_class(ChordPanel)


def unregister() -> None:
    """Takes it back."""
    bpy.utils.unregister_class(ChordPanel)
