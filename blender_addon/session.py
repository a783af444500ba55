"""The one job that may run, and what to do when it ends; it lives as long as Blender does."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Any

import bpy

from .core.claim import Claims
from .core.errors import InputError
from .core.job import CANCEL_GRACE_S, Job, Outcome
from .core.program import Program, ProgramError, find_program
from .preferences import preferences
from .properties import fields

POLL_EVERY_S = 0.2

Finish = Callable[[bpy.types.Context, dict[str, Any]], None]
"""What to do with the program's report."""


class Session:
    """Runs jobs one at a time; a timer looks after the running one while Blender stays usable."""

    def __init__(self) -> None:
        self.job: Job | None = None
        self.claims = Claims()
        self.moved: dict[str, str] = {}
        """Houses that went beside their Blender file when it got a name."""
        self._finish: Finish | None = None
        self._scene_uid = 0
        self._programs: dict[str, Program] = {}

    @property
    def is_running(self) -> bool:
        """Whether a job runs now."""
        return self.job is not None and self.job.outcome is None

    def place_of(self, house: str) -> str:
        """Where a house is now: what was undone knows the place that it had before."""
        return self.moved.get(house, house)

    def program(self, preference: str) -> Program:
        """The program of this preference, asked once. Raises ProgramError."""
        if preference not in self._programs:
            self._programs[preference] = find_program(preference)
        return self._programs[preference]

    def known_program(self, preference: str) -> Program | None:
        """The program of this preference, if it has been asked."""
        return self._programs.get(preference)

    def forget_programs(self) -> None:
        """Ask again the next time: something may have been installed."""
        self._programs.clear()

    def ask_ahead(self, preference: str) -> None:
        """Ask the program in a thread, so that nobody waits for its answer."""

        def ask() -> None:
            with suppress(ProgramError):  # reported when it is needed
                self.program(preference)

        threading.Thread(target=ask, daemon=True).start()

    def start(self, context: bpy.types.Context, arguments: Sequence[str], finish: Finish) -> None:
        """Start a job. Raises core.program.ProgramError where there is no program for it."""
        program = self.program(preferences(context).program)
        self.start_command(context, [*program.command, *arguments], finish)

    def start_command(
        self, context: bpy.types.Context, command: Sequence[str], finish: Finish
    ) -> None:
        """Start a job of another program that reports progress as chord-usd does."""
        self.job = Job(command)
        self._finish = finish
        self._scene_uid = context.scene.session_uid
        props = fields(context)
        props.error = props.note = ""
        self.job.start()
        if not bpy.app.timers.is_registered(self._tick):
            bpy.app.timers.register(self._tick, first_interval=POLL_EVERY_S, persistent=True)

    def step(self, context: bpy.types.Context) -> bool:
        """Look after the job once; True until it, and one that follows it, is dealt with."""
        if self.job is None:
            return False
        if not self.job.poll() and self._finish is not None:
            finish, self._finish = self._finish, None
            assert self.job.outcome is not None
            if self.job.outcome.data is None:
                self.claims.drop_empty()
            self._end(context, self.job.outcome, finish)
        return self._finish is not None

    def cancel(self) -> None:
        """Stop the running job."""
        if self.job is not None:
            self.job.cancel()

    def leave_file(self) -> None:
        """Another file is opened: what runs is not for that."""
        job = self.job
        self.job = self._finish = None
        if job is None or job.outcome is not None:
            self.claims.release()
            return
        job.cancel()
        left, self.claims = self.claims, Claims()
        left.release(but_empty=True)
        # The program may take a while to clean up; what was made for it goes after that.
        threading.Thread(target=_tidy, args=(job, left)).start()

    def _tick(self) -> float | None:
        running = self.step(bpy.context)
        for window in bpy.context.window_manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()
        return POLL_EVERY_S if running else None

    def _end(self, context: bpy.types.Context, outcome: Outcome, finish: Finish) -> None:
        """Hand the report on in the scene that the job was started in, where that still is."""
        scene = next((s for s in bpy.data.scenes if s.session_uid == self._scene_uid), None)
        if outcome.cancelled or scene is None:
            return
        # Timers have no window, and operators ask for one.
        windows = list(context.window_manager.windows)
        window = next((w for w in windows if w.scene == scene), windows[0] if windows else None)
        shown = window is not None and window.scene == scene
        layer = window.view_layer if shown else scene.view_layers[0]
        with context.temp_override(window=window, scene=scene, view_layer=layer):
            if outcome.data is None:
                fields(bpy.context).error = outcome.error
                return
            try:
                finish(bpy.context, outcome.data)
            except (InputError, ProgramError) as error:
                fields(bpy.context).error = str(error)
                return
            except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
                fields(bpy.context).error = f"the answer could not be used: {error}"
                return
            if self._finish is None:  # the last of its jobs: all of them are one step to undo
                bpy.ops.ed.undo_push(message="CHOrD")


def _tidy(job: Job, claims: Claims) -> None:
    """Wait for a cancelled job, and leave nothing of what was made for it."""
    with suppress(TimeoutError):
        job.wait(2 * CANCEL_GRACE_S)
    claims.release()


session = Session()
