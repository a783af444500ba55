"""The extension's preferences: which chord-usd does the work."""

from __future__ import annotations

import bpy

from .core.program import ProgramError
from .core.state import wrapped

LINE_LETTERS = 90
"""Letters that fit a line of the preferences."""


def _ask_ahead(settings: ChordPreferences, _context: bpy.types.Context) -> None:
    """The panel offers what the program can, as soon as there is one."""
    from .session import session

    session.ask_ahead(settings.program)


class ChordPreferences(bpy.types.AddonPreferences):
    """Where chord-usd is, and what a check of it said."""

    bl_idname = __package__

    program: bpy.props.StringProperty(  # type: ignore[valid-type]
        name="chord-usd or its Python",
        description="Path of the chord-usd program, of the Python it is installed in, or of that "
        "environment's folder; empty: found automatically",
        subtype="FILE_PATH",
        update=_ask_ahead,
    )
    answer: bpy.props.StringProperty(options={"SKIP_SAVE"})  # type: ignore[valid-type]

    def draw(self, _context: bpy.types.Context) -> None:
        """The preferences' page."""
        row = self.layout.row()
        row.prop(self, "program")
        row.operator(ChordCheckProgram.bl_idname, text="Check")
        for line in wrapped(self.answer, LINE_LETTERS):
            self.layout.label(text=line)


class ChordCheckProgram(bpy.types.Operator):
    """Start chord-usd and ask for its version"""

    bl_idname = "chord.check_program"
    bl_label = "Check chord-usd"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Leaves the answer in the preferences."""
        from .session import session

        settings = preferences(context)
        session.forget_programs()
        try:
            settings.answer = f"Found {session.program(settings.program).label}"
        except ProgramError as error:
            settings.answer = str(error)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, settings.answer)
        return {"FINISHED"}


def preferences(context: bpy.types.Context) -> ChordPreferences:
    """This extension's preferences."""
    return context.preferences.addons[__package__].preferences


_CLASSES = (ChordPreferences, ChordCheckProgram)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
