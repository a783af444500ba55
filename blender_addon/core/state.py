"""What the panel shows: one of a few states, each with what can be done in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .job import Job, Progress
from .program import options_of

Phase = Literal["EMPTY", "RUNNING", "FAILED", "DONE"]

OFFERED_BY = {"PLAN": "", "TEXT": "--text", "OUTLINE": "--outline"}
"""Ways to say what house is wanted, and the option of `generate` that each needs."""

STEP_NAMES = {
    "load": "Starting",
    "plan": "Reading the plan",
    "layout": "Drawing the layout",
    "graph": "Finding the furniture",
    "stage": "Building the house",
    "redraw": "Drawing some rooms again",
    "outliers": "Judging the layout",
    "tabletop": "Laying the tables",
    "settle": "Putting the furniture right",
    "dress": "Dressing the rooms",
    "read": "Reading the house",
    "describe": "Reading the house",
    "check": "Checking",
    "assets": "Drawing the models",
    "pictures": "Drawing the pictures",
    "library": "Building the library",
    "render": "Rendering",
}

PLANNING = "Planning the rooms"
"""The step "plan" of a job that was given none."""


@dataclass(frozen=True)
class PanelState:
    """A snapshot for drawing."""

    phase: Phase
    message: str = ""
    share: float = 0.0

    @property
    def can_start(self) -> bool:
        """Whether a job may be started now; there is one at a time."""
        return self.phase != "RUNNING"


def panel_state(job: Job | None, house: str, error: str) -> PanelState:
    """The state of the panel from the running job, the house at hand and the last error."""
    if job is not None and job.outcome is None:
        is_planning = not set(OFFERED_BY.values()).isdisjoint(options_of(job.command))
        return PanelState("RUNNING", progress_text(job.progress, is_planning), _share(job.progress))
    if error:
        return PanelState("FAILED", error)
    return PanelState("DONE", house) if house else PanelState("EMPTY")


def progress_text(progress: Progress | None, is_planning: bool = False) -> str:
    """Where the program stands, in words. is_planning: it is to find a plan, not to read one."""
    if progress is None:
        return "Starting"
    words = STEP_NAMES.get(progress.step, progress.step.capitalize())
    if is_planning and progress.step == "plan":
        words = PLANNING
    return f"{words} {progress.share:.0%}" if progress.total > 1 else words


def _share(progress: Progress | None) -> float:
    return progress.share if progress else 0.0


def wrapped(text: str, width: int) -> list[str]:
    """A sentence as lines for a narrow panel; words longer than a line are cut."""
    lines, line = [], ""
    for word in text.split():
        while len(word) > width:
            room = width - len(line) - 1 if line else width
            if room < width // 3:
                lines.append(line)
                line = ""
                continue
            line = f"{line} {word[:room]}".strip()
            word = word[room:]
            lines.append(line)
            line = ""
        if len(line) + len(word) + 1 > width and line:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}".strip()
    return [*lines, line] if line else lines
