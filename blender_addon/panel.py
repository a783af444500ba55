"""The sidebar panels: they draw the state and decide nothing."""

from __future__ import annotations

from pathlib import Path

import bpy

from .core import report, swaps
from .core.options import OF_FILES, ROWS
from .core.program import EDITS_IN_WORDS, WISHES_FROM
from .core.state import OFFERED_BY, panel_state, wrapped
from .core.tree import has_roof, is_dressing, piece_of, storeys
from .house import LOCKED_KEY, Objects, arranged, chosen_path, own_objects, pieces_of
from .jobs import keeps_past, unsaved_folder
from .preferences import preferences
from .previews import icon
from .properties import chosen_room, fields, parsed
from .session import session

LINE_LETTERS = 42
"""Letters that fit a line of the sidebar."""

EXAMPLE = "a two-bedroom flat with an open kitchen, about 70 m²"
"""Stands in the empty text field."""

SENTENCE = "put a plant in bedroom 1"
"""Stands in the empty field for changes."""

PLAN_SCALE, MODEL_SCALE = 8.0, 4.0
"""Sides of thumbnails, in heights of a button."""


class _Part:
    """A part of the tab."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "CHOrD"


class ChordPanel(_Part, bpy.types.Panel):
    """What house is wanted, and how far it is"""

    bl_idname = "VIEW3D_PT_chord"
    bl_label = "CHOrD"

    def draw(self, context: bpy.types.Context) -> None:
        """Source, button and state."""
        props = fields(context)
        state = panel_state(session.job, props.house, props.error)
        column = self.layout.column()
        column.enabled = state.can_start
        _draw_source(column, context)
        row = column.row(align=True)
        row.operator("chord.generate", icon="HOME")
        row.operator("chord.open_house", text="", icon="FILE_FOLDER")
        if state.phase == "RUNNING":
            self.layout.progress(factor=state.share, text=state.message)
            self.layout.operator("chord.cancel", icon="CANCEL")
        if state.phase == "FAILED":
            _draw_text(self.layout.box(), state.message, "ERROR")
        if state.phase == "DONE":
            _draw_made(self.layout, props)
        if props.note:
            _draw_text(self.layout, props.note, "INFO")
        if props.house and Path(session.place_of(props.house)).is_relative_to(unsaved_folder()):
            text = "The house is in a temporary folder until the Blender file is saved."
            _draw_text(self.layout, text, "INFO")


class _HousePart(_Part):
    """A part that is there once there is a house."""

    bl_parent_id = ChordPanel.bl_idname

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a house."""
        return bool(fields(context).rooms)


class ChordRoomsPanel(_HousePart, bpy.types.Panel):
    """The rooms, and what can be done with the chosen one"""

    bl_idname = "VIEW3D_PT_chord_rooms"
    bl_label = "Rooms"

    def draw(self, context: bpy.types.Context) -> None:
        """The list, and the chosen room below it."""
        props, layout = fields(context), self.layout
        layout.template_list(
            "UI_UL_list", "chord_rooms", props, "rooms", props, "room_index", rows=4
        )
        row = layout.row(align=True)
        row.operator("chord.frame_room", icon="VIEWZOOM")
        start = _when_idle(row.row(align=True))
        start.operator("chord.regenerate", icon="FILE_REFRESH")
        program = session.known_program(preferences(context).program)
        if program and WISHES_FROM in program.abilities:
            layout.prop(props, "wanted", placeholder="desk, two chairs")
            layout.prop(props, "unwanted", placeholder="sofa")
        if asked := report.requests(parsed(props.contents), chosen_room(context)):
            _draw_text(layout, f"Asked for: {asked}", "INFO")
        row = layout.row()
        row.prop(props, "solo")
        row.prop(props, "hide_ceilings")
        if has_roof(line.path for line in props.objects):
            layout.prop(props, "show_roof")
        if storeys(line.path for line in props.objects):
            layout.prop(props, "storey")
        layout.prop(props.rooms[props.room_index], "light", slider=True)
        looks = _when_idle(layout.column())
        for look in report.looks(parsed(props.contents)):
            if look.path in ("/House", chosen_path(context)):
                _draw_look(looks, look)
        looks.operator("chord.shuffle_looks", icon="FILE_REFRESH")
        row = layout.row(align=True)
        row.operator("chord.save_edits", icon="FILE_TICK")
        discard = _when_idle(row.row(align=True))
        discard.operator("chord.discard_edits", text="", icon="LOOP_BACK")


class ChordWordsPanel(_HousePart, bpy.types.Panel):
    """The house changed by saying what it should be"""

    bl_idname = "VIEW3D_PT_chord_words"
    bl_label = "In words"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a house, and a program that takes changes in words."""
        program = session.known_program(preferences(context).program)
        return super().poll(context) and bool(program and EDITS_IN_WORDS in program.abilities)

    def draw(self, context: bpy.types.Context) -> None:
        """The sentence; what it was taken to mean, and the button that does it."""
        props, layout = fields(context), self.layout
        layout.prop(props, "sentence", text="", placeholder=SENTENCE)
        buttons = _when_idle(layout.column())
        buttons.operator("chord.read_sentence", icon="QUESTION")
        if props.understood and props.understood_of == props.sentence:
            box = buttons.box()
            for line in props.understood.splitlines():
                _draw_text(box, line, "CHECKMARK")
            box.operator("chord.edit_by_words", icon="PLAY")


class ChordHistoryPanel(_HousePart, bpy.types.Panel):
    """What was done to the house; each of it can be had again"""

    bl_idname = "VIEW3D_PT_chord_history"
    bl_label = "History"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a house, and a program that keeps its history."""
        return super().poll(context) and keeps_past(context)

    def draw(self, context: bpy.types.Context) -> None:
        """One step back or on, and the list."""
        props = fields(context)
        row = _when_idle(self.layout.row(align=True))
        # What the artist has just moved is no change of the list yet, so undo is never grey.
        row.operator("chord.undo", text="Undo", icon="LOOP_BACK")
        on = row.row(align=True)
        on.enabled = props.can_redo
        on.operator("chord.redo", text="Redo", icon="LOOP_FORWARDS")
        row.operator("chord.read_history", text="", icon="FILE_REFRESH")
        if props.past:
            self.layout.template_list(
                "UI_UL_list", "chord_past", props, "past", props, "past_index", rows=4
            )
            _when_idle(self.layout.row()).operator("chord.go_to", icon="TIME")


class ChordFurniturePanel(_HousePart, bpy.types.Panel):
    """The furniture of the chosen room"""

    bl_idname = "VIEW3D_PT_chord_furniture"
    bl_label = "Furniture"

    def draw(self, context: bpy.types.Context) -> None:
        """A line for each piece."""
        pieces = pieces_of(context, chosen_room(context))
        _draw_pieces(self.layout, context, {p: i for p, i in pieces.items() if not is_dressing(p)})


class ChordDressingPanel(_HousePart, bpy.types.Panel):
    """What the chosen room is dressed with"""

    bl_idname = "VIEW3D_PT_chord_dressing"
    bl_label = "Dressing"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is any in the room."""
        return super().poll(context) and any(
            map(is_dressing, pieces_of(context, chosen_room(context)))
        )

    def draw(self, context: bpy.types.Context) -> None:
        """A line for each thing, as of furniture."""
        pieces = pieces_of(context, chosen_room(context))
        _draw_pieces(self.layout, context, {p: i for p, i in pieces.items() if is_dressing(p)})


class ChordCertificatePanel(_HousePart, bpy.types.Panel):
    """What is wrong with the house"""

    bl_idname = "VIEW3D_PT_chord_certificate"
    bl_label = "Certificate"

    def draw(self, context: bpy.types.Context) -> None:
        """The verdict and the list of findings."""
        props = fields(context)
        row = self.layout.row()
        row.label(text=props.certificate or "Not checked yet")
        start = _when_idle(row.row())
        start.operator("chord.check_house", icon="CHECKMARK")
        for index, finding in enumerate(props.findings):
            icon_name = "INFO" if finding.is_planning else "ERROR"
            shown = self.layout.operator("chord.show_finding", text=finding.name, icon=icon_name)
            shown.index = index


class ChordRenderPanel(_HousePart, bpy.types.Panel):
    """Pictures of the house"""

    bl_idname = "VIEW3D_PT_chord_render"
    bl_label = "Render"

    def draw(self, context: bpy.types.Context) -> None:
        """Which pictures, and where they are made."""
        props = fields(context)
        self.layout.prop(props, "all_rooms")
        if not props.all_rooms:
            self.layout.prop_search(props, "render_room", props, "rooms", icon="CAMERA_DATA")
        self.layout.prop(props, "samples")
        self.layout.prop(props, "passes")
        self.layout.prop(props, "render_folder")
        start = _when_idle(self.layout.row())
        start.operator("chord.render", icon="RENDER_STILL")
        self.layout.prop(props, "farm_folder")
        start = _when_idle(self.layout.row())
        start.operator("chord.write_farm_job", icon="NETWORK_DRIVE")


class ChordLibraryPanel(_Part, bpy.types.Panel):
    """The furniture in Blender's asset browser"""

    bl_idname = "VIEW3D_PT_chord_library"
    bl_label = "Asset library"
    bl_parent_id = ChordPanel.bl_idname
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        """Where it goes, and the button that builds it."""
        self.layout.prop(fields(context), "library_folder")
        start = _when_idle(self.layout.row())
        start.operator("chord.build_library", icon="ASSET_MANAGER")


def _when_idle(part: bpy.types.UILayout) -> bpy.types.UILayout:
    """A part of the layout that is grey while a job runs."""
    part.enabled = not session.is_running
    return part


def _draw_source(column: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What the house is made from; ways that the program does not have are not offered."""
    props = fields(context)
    program = session.known_program(preferences(context).program)
    abilities = program.abilities if program else frozenset()
    ways = [way for way, option in OFFERED_BY.items() if not option or option in abilities]
    if len(ways) > 1 or props.source not in ways:
        row = column.row(align=True)
        for way in ways:
            row.prop_enum(props, "source", way)
    lacking = program.lacking(filter(None, OFFERED_BY.values())) if program else ""
    if lacking:
        _draw_text(column, lacking, "INFO")
    if props.source != "TEXT":
        _draw_file(column, props, "plan" if props.source == "PLAN" else "outline")
    if props.source != "PLAN":
        hint = EXAMPLE if props.source == "TEXT" else "Which rooms, if you like"
        column.prop(props, "text", text="", placeholder=hint)
    for option in ROWS:
        is_of_files = option["name"] in OF_FILES
        if (program and not program.has(option)) or (is_of_files and props.source == "TEXT"):
            continue
        row = column.row(align=True)
        row.prop(props, option["name"])
        if option["name"] == "seed":
            row.operator("chord.dice", text="", icon="FILE_REFRESH")


def _draw_file(column: bpy.types.UILayout, props: bpy.types.PropertyGroup, field: str) -> None:
    """A file to choose, and its thumbnail."""
    column.prop(props, field, text="")
    chosen = getattr(props, field)
    thumbnail = icon(Path(bpy.path.abspath(chosen))) if chosen else 0
    if thumbnail:
        column.template_icon(icon_value=thumbnail, scale=PLAN_SCALE)


def _draw_made(layout: bpy.types.UILayout, props: bpy.types.PropertyGroup) -> None:
    """What was understood of a text, what was planned, and what is not as it was asked for."""
    if props.planned or props.warnings:
        box = layout.box()
        for line in props.planned.splitlines():
            _draw_text(box, line, "CHECKMARK")
        for line in props.warnings.splitlines():
            _draw_text(box, line, "ERROR")


def _draw_pieces(layout: bpy.types.UILayout, context: bpy.types.Context, pieces: Objects) -> None:
    """A line for each piece; models to choose from below the one that is to be swapped."""
    props = fields(context)
    looks, models = report.looks(parsed(props.contents)), report.models(parsed(props.contents))
    for path, item in pieces.items():
        row = layout.row(align=True)
        name = report.spaced(path.split("/")[-1])
        row.operator("chord.select_piece", text=name, icon="RESTRICT_SELECT_OFF").path = path
        lock = "LOCKED" if item.get(LOCKED_KEY) else "UNLOCKED"
        row.operator("chord.lock_piece", text="", icon=lock).path = path
        start = _when_idle(row.row(align=True))
        start.operator("chord.find_models", text="", icon="UV_SYNC_SELECT").path = path
        row.operator("chord.delete_piece", text="", icon="TRASH").path = path
        if piece_of(props.swap_path) == path:
            if text := arranged(own_objects(context), path):
                _draw_text(layout, text, "INFO")
            box = _when_idle(layout.box())
            _draw_models(box, props, models.get(props.swap_path, ""))
            for look in looks:
                if look.path == props.swap_path:
                    _draw_look(box, look)


def _draw_models(box: bpy.types.UILayout, props: bpy.types.PropertyGroup, worn: str) -> None:
    """What could stand in a piece's place, but for the model that does."""
    for index, model in enumerate(swaps.candidates(parsed(props.swap_models))):
        if model.id == worn:
            continue
        row = box.row()
        thumbnail = icon(model.picture)
        if thumbnail:
            row.template_icon(icon_value=thumbnail, scale=MODEL_SCALE)
        row.operator("chord.swap", text=model.label).index = index


def _draw_look(layout: bpy.types.UILayout, look: report.Look) -> None:
    layout.label(text=look.label)
    row = layout.row(align=True)
    for variant in look.offered:
        button = row.operator(
            "chord.choose_look", text=report.spaced(variant), depress=variant == look.chosen
        )
        button.path, button.variant_set, button.variant = look.path, look.variant_set, variant


def _draw_text(layout: bpy.types.UILayout, text: str, icon_name: str) -> None:
    column = layout.column(align=True)
    for number, line in enumerate(wrapped(text, LINE_LETTERS)):
        column.label(text=line, icon="NONE" if number else icon_name)


PANELS = (
    ChordPanel,
    ChordRoomsPanel,
    ChordWordsPanel,
    ChordHistoryPanel,
    ChordFurniturePanel,
    ChordDressingPanel,
    ChordCertificatePanel,
    ChordRenderPanel,
    ChordLibraryPanel,
)

register, unregister = bpy.utils.register_classes_factory(PANELS)
