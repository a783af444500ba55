"""Words or outer walls -> Plan: the other ways in, before the straight line begins.

text -> Wish and words -> label maps -> Plan; outline file -> shell -> label maps -> Plan. Several
floors are planned at once and the best of them is taken (planning.choose).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.errors import PlanError
from chord_usd.locations import checkpoint_folder
from chord_usd.pipeline import Settings, read_plan
from chord_usd.progress import Progress
from chord_usd.types import Plan, PlanImage
from chord_usd.wish import NAMES, Wish

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from chord_usd.layout.sample import LayoutModel
    from chord_usd.planning.choose import Candidate
    from chord_usd.planning.encoder import TextEncoder

TEXT_CHECKPOINT = "text2plan"
OUTLINE_CHECKPOINT = "outline2plan"

BATCH = 4
ROUNDS = 4
"""At most so many batches of floors are planned, fewer where one is all that was asked for."""

MANY_ROOMS = 10
"""With more rooms than this, and no area named, a large house is expected."""


@dataclass(frozen=True, eq=False)
class Planned:
    """A planned floor."""

    chosen: Candidate
    tried: tuple[Candidate, ...]
    """Every floor that was planned to find it, in order."""
    wish: Wish
    understood: str
    """The wish in short, "" where there is none."""

    @property
    def plan(self) -> Plan:
        """The plan itself."""
        return self.chosen.plan

    @property
    def warnings(self) -> list[str]:
        """What was asked for and could not be had, and what is wrong with the plan."""
        missed = [
            f"asked for {asked} {NAMES[kind][asked != 1]}, planned {planned}"
            for kind, (asked, planned) in self.chosen.missed.items()
        ]
        if self.chosen.area_missed:
            area_m2 = self.chosen.area_m2
            missed.append(f"asked for {self.wish.area_m2:.0f} m², planned {area_m2:.0f}")
        return [*missed, *self.chosen.faults]


def load_planner(name: str, settings: Settings) -> LayoutModel:
    """The model of TEXT_CHECKPOINT or OUTLINE_CHECKPOINT. Raises CheckpointError."""
    from chord_usd.layout.sample import LayoutModel

    return LayoutModel.load(checkpoint_folder(name), settings.device)


def plan_from_text(
    text: str,
    settings: Settings,
    model: LayoutModel | None = None,
    encoder: TextEncoder | None = None,
    progress: Progress | None = None,
) -> Planned:
    """A floor plan that a text asks for. Raises ChordError for a text that asks for none.

    model, encoder: those of earlier plans; by default they are loaded.
    """
    from chord_usd import plan_labels
    from chord_usd.planning.encoder import default_encoder
    from chord_usd.planning.sheet import blank_sheet
    from chord_usd.planning.wording import read_wish
    from chord_usd.planning.words import condition_words

    found = read_wish(text)
    wish = found.wish
    encoder = encoder or default_encoder()
    said = text if found.english else wish.sentence
    words = condition_words(wish, encoder.encode([said])[0])
    coarse = wish.rooms > MANY_ROOMS
    scale = plan_labels.SCALES_M[coarse]
    if wish.area_m2 is not None:
        scale = plan_labels.scale_for_area(wish.area_m2)
    sheet = blank_sheet(plan_labels.sheet_frame(scale))
    model = model or load_planner(TEXT_CHECKPOINT, settings)
    return _planned(model, sheet, words, wish, None, settings, found.told, progress)


def plan_from_outline(
    outline_file: Path,
    settings: Settings,
    text: str = "",
    model: LayoutModel | None = None,
    progress: Progress | None = None,
) -> Planned:
    """Rooms for the open plan in a file: outer walls, and the windows and doors in them.

    text: what the rooms shall be, "" to leave it open. Raises ChordError for an unusable one.
    """
    from chord_usd.planning.outline import shell_of
    from chord_usd.planning.wording import read_wish

    shell = shell_of(read_plan(outline_file, settings), str(outline_file))
    found = read_wish(text) if text else None
    model = model or load_planner(OUTLINE_CHECKPOINT, settings)
    wish, told = (found.wish, found.told) if found else (Wish(), "")
    return plan_in_shell(shell, wish, model, settings, told, progress)


def plan_in_shell(
    shell: Plan,
    wish: Wish,
    model: LayoutModel,
    settings: Settings,
    told: str = "",
    progress: Progress | None = None,
) -> Planned:
    """Rooms in an open plan of one room. wish: its area is not looked at."""
    from chord_usd import plan_labels
    from chord_usd.planning.outline import shell_labels
    from chord_usd.planning.words import condition_words

    labels, frame = shell_labels(shell)
    sheet = PlanImage(plan_labels.paint_labels(labels), frame)
    wish = Wish(wish.counts, None, wish.open_kitchen)
    return _planned(model, sheet, condition_words(wish), wish, shell, settings, told, progress)


def _planned(
    model: LayoutModel,
    sheet: PlanImage,
    words: npt.NDArray[np.float32],
    wish: Wish,
    shell: Plan | None,
    settings: Settings,
    told: str,
    progress: Progress | None,
) -> Planned:
    from chord_usd.planning.choose import best, judged

    candidates: list[Candidate] = []
    for batch in range(ROUNDS):
        first = (settings.seed * ROUNDS + batch) * BATCH
        plans = sampled(model, sheet, words, shell, range(first, first + BATCH), settings, progress)
        candidates += [judged(plan, wish) for plan in plans]
        if any(candidate.holds for candidate in candidates):
            break
    chosen = best(candidates)
    if not chosen.plan.rooms:
        raise PlanError(
            f"no floor could be planned for {told or 'this outline'}",
            expected="something like the homes that the model has learned from",
            try_="another --seed, or fewer wishes",
        )
    return Planned(chosen, tuple(candidates), wish, told)


def sampled(
    model: LayoutModel,
    sheet: PlanImage,
    words: npt.NDArray[np.float32],
    shell: Plan | None,
    seeds: range,
    settings: Settings,
    progress: Progress | None = None,
) -> list[Plan]:
    """One plan per seed, as the model draws them."""
    import numpy as np

    from chord_usd.planning.partition import plan_from_labels

    maps = model.sample_labels(
        [sheet] * len(seeds),
        np.stack([words] * len(seeds)),
        seeds=list(seeds),
        steps=settings.steps,
        progress=progress,
    )
    return [plan_from_labels(labels, sheet.frame, shell) for labels in maps]
