"""Words or outer walls -> Plan: the other ways in, before the straight line begins.

text -> Wish and words -> bubble diagrams -> label maps -> Plan; outline file -> shell -> bubble
diagrams -> label maps -> Plan. Several floors are planned at once and the best of them is taken
(planning.choose).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.bubbles import Bubble, stretched, with_bubbles
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import ByteArray, Plan, PlanImage
from chord_usd.base.scene.wish import NAMES, Wish, with_wished_wet
from chord_usd.line.pipeline import Settings

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from chord_usd.line.layout.sample import LayoutModel
    from chord_usd.line.planning.choose import Candidate
    from chord_usd.line.planning.encoder import TextEncoder
    from chord_usd.line.planning.sketcher import Ground, Sketcher

TEXT_CHECKPOINT = "text2plan"
OUTLINE_CHECKPOINT = "outline2plan"
SKETCH_CHECKPOINT = "bubbles"

BATCH = 2
ROUNDS = 8
"""At most so many batches of floors are planned, fewer where one is all that was asked for."""

MOST_STRETCH = 0.1
"""In length, by which a floor is drawn larger or smaller to have the area that was asked for."""

_SAME_LENGTH = 0.01
"""A floor that is off by less is left as it is."""

SKETCHES = 4
"""So many bubble diagrams are drawn for each that is carried out: the likeliest."""

PATIENT_ROUNDS = 4
"""After so many, a floor will do that was not all that its open plan's programme says."""


@dataclass(frozen=True, eq=False)
class Commission:
    """What is to be planned, as the network is told it."""

    wish: Wish
    understood: str
    """The wish in short, "" where there is none."""
    words: npt.NDArray[np.float32]
    """(words, channels), planning.words."""
    shell: Plan | None = None
    """The open plan that it is planned in; None where the house's shape is left open."""
    unheard: tuple[str, ...] = ()
    """What of the text is not heard, and why."""


@dataclass(frozen=True, eq=False)
class Site:
    """Where the floors of a commission are sketched, and what for."""

    blank: PlanImage | None
    """The sheet with the open plan on it; None where the house's shape is left open."""
    ground: Ground
    programme: Wish
    """In an open plan, how many rooms of every kind; elsewhere only what was asked for."""


@dataclass(frozen=True, eq=False)
class Drawing:
    """What a floor is drawn on."""

    sheet: PlanImage
    """With the diagram on it."""
    bubbles: tuple[Bubble, ...]


@dataclass(frozen=True, eq=False)
class Planner:
    """The networks that plan floors."""

    sketcher: Sketcher
    model: LayoutModel

    @property
    def content_hash(self) -> str:
        """Tells these networks from others."""
        return f"{self.sketcher.content_hash}+{self.model.checkpoint.content_hash}"


@dataclass(frozen=True, eq=False)
class Planned:
    """A planned floor."""

    chosen: Candidate
    tried: tuple[Candidate, ...]
    """Every floor that was planned to find it, in order."""
    commission: Commission

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
            missed.append(f"asked for {self.commission.wish.area_m2:.0f} m², planned {area_m2:.0f}")
        return [*self.commission.unheard, *missed, *self.chosen.faults]


def load_planner(name: str, settings: Settings) -> Planner:
    """The networks for TEXT_CHECKPOINT or OUTLINE_CHECKPOINT. Raises CheckpointError."""
    from chord_usd.line.layout.sample import LayoutModel

    return planner_of(LayoutModel.load(checkpoint_folder(name), settings.device))


def planner_of(model: LayoutModel) -> Planner:
    """A network of either checkpoint, with the one that sketches. Raises CheckpointError."""
    from chord_usd.line.planning.sketcher import load_sketcher

    return Planner(load_sketcher(checkpoint_folder(SKETCH_CHECKPOINT)), model)


def plan_from_text(text: str, settings: Settings, progress: Progress | None = None) -> Planned:
    """A floor plan that a text asks for. Raises ChordError for a text that asks for none."""
    from chord_usd.line.planning.encoder import encoder_of

    checkpoint = checkpoint_folder(TEXT_CHECKPOINT)
    commission = commission_of_text(text, partial(encoder_of, checkpoint))
    return carry_out(commission, load_planner(TEXT_CHECKPOINT, settings), settings, progress)


def plan_from_outline(
    outline_file: Path, settings: Settings, text: str = "", progress: Progress | None = None
) -> Planned:
    """Rooms for the open plan in a file: outer walls, and the windows and doors in them.

    text: the wanted rooms, "" to leave them open. Raises ChordError for an unusable one.
    """
    from chord_usd.line.plan.read import read_plan_file
    from chord_usd.line.planning.outline import shell_of

    drawn = read_plan_file(outline_file, settings.m_per_px, settings.part, is_open=True)
    shell = shell_of(drawn, str(outline_file))
    commission = commission_in_shell(shell, text)
    return carry_out(commission, load_planner(OUTLINE_CHECKPOINT, settings), settings, progress)


def commission_of_text(text: str, load_encoder: Callable[[], TextEncoder]) -> Commission:
    """What a text asks for. Raises ChordError for a text that asks for nothing that can be had.

    The encoder is loaded, which takes seconds, once the text is known to be usable.
    """
    from chord_usd.line.planning.wording import read_wish
    from chord_usd.line.planning.words import condition_words

    heard = read_wish(text)
    wish = heard.wish
    said = text if heard.english else wish.sentence
    encoder = load_encoder()
    words = condition_words(wish, encoder.encode([said])[0], encoder.channels)
    return Commission(wish, heard.summary, words, unheard=heard.warnings)


def commission_in_shell(shell: Plan, text: str = "") -> Commission:
    """Rooms in an open plan of one room. Raises ChordError as commission_of_text, unless text is
    ""; the walls say how large the house is, whatever the text does."""
    from chord_usd.line.planning.wording import read_wish
    from chord_usd.line.planning.words import condition_words

    heard = read_wish(text) if text else None
    wish = replace(heard.wish, area_m2=None) if heard else Wish()
    words = condition_words(wish)
    if not heard:
        return Commission(wish, "", words, shell)
    return Commission(wish, heard.summary, words, shell, heard.warnings)


def carry_out(
    commission: Commission,
    planner: Planner,
    settings: Settings,
    progress: Progress | None = None,
) -> Planned:
    """Floors are planned batch by batch until one is all that was asked for, and the best taken.

    In an open plan one that lacks rooms of its programme waits PATIENT_ROUNDS for a better one.
    Raises PlanError where nothing that has rooms could be planned.
    """
    from chord_usd.line.planning.choose import best, judged

    site = _site(commission, planner.sketcher, settings.seed)
    tried: list[Candidate] = []
    for batch in range(ROUNDS):
        first = (settings.seed * ROUNDS + batch) * BATCH
        seeds = range(first, first + BATCH)
        plans = _sampled(commission, site, planner, seeds, settings.steps, progress)
        tried += [judged(plan, commission.wish, site.programme) for plan in plans]
        patient = batch + 1 < PATIENT_ROUNDS
        if any(attempt.holds and not (patient and attempt.off_programme) for attempt in tried):
            break
    chosen = best(tried)
    if not chosen.plan.rooms:
        raise PlanError(
            f"no floor could be planned for {commission.understood or 'this outline'}",
            expected="something like the homes that the model has learned from",
            try_=("another <seed>", "fewer wishes"),
        )
    chosen = replace(chosen, plan=with_wished_wet(chosen.plan, commission.wish))
    return Planned(chosen, tuple(tried), commission)


def _site(commission: Commission, sketcher: Sketcher, seed: int) -> Site:
    """The programme of an open plan is settled before anything is sketched in it: among floors of
    several programmes those with few rooms, which are easily drawn, would win."""
    from chord_usd.line.planning.floor_sheet import shell_sheet
    from chord_usd.line.planning.sketcher import open_ground

    if commission.shell is None:
        return Site(None, open_ground(), commission.wish)
    blank, ground = shell_sheet(commission.shell)
    counts = sketcher.programme(commission.wish, ground, seed)
    return Site(blank, ground, replace(commission.wish, counts=counts))


def _sampled(
    commission: Commission,
    site: Site,
    planner: Planner,
    seeds: range,
    steps: int | None,
    progress: Progress | None,
) -> list[Plan]:
    """One plan per seed."""
    import numpy as np

    from chord_usd.line.planning.partition import plan_from_labels

    drawings = _sketched(site, planner.sketcher, seeds)
    maps = planner.model.sample_labels(
        [drawing.sheet for drawing in drawings],
        np.stack([commission.words] * len(seeds)),
        seeds=list(seeds),
        steps=steps,
        progress=progress,
    )
    area_m2 = commission.wish.area_m2 if commission.shell is None else None
    return [
        _at_size(labels, drawing, area_m2)
        if area_m2 is not None
        else plan_from_labels(labels, drawing.sheet.frame, commission.shell, drawing.bubbles)
        for labels, drawing in zip(maps, drawings, strict=True)
    ]


def _sketched(site: Site, sketcher: Sketcher, seeds: range) -> list[Drawing]:
    """For each seed: the open plan, or none, and the kinds of the rooms in it."""
    from chord_usd.line.planning import floor_sheet

    count = SKETCHES * len(seeds)
    ranked = []
    for sketch in sketcher.sketch(site.programme, site.ground, count, seeds[0]):
        blank = site.blank or floor_sheet.sheet_for_area(sketch.area_m2)
        bubbles = floor_sheet.on_sheet(blank, sketch.bubbles)
        ranked.append((floor_sheet.slips(blank, bubbles), -sketch.likelihood, blank, bubbles))
    ranked.sort(key=lambda entry: entry[:2])
    return [
        Drawing(with_bubbles(blank, bubbles), bubbles)
        for _, _, blank, bubbles in ranked[: len(seeds)]
    ]


def _at_size(labels: ByteArray, drawing: Drawing, area_m2: float) -> Plan:
    """The plan of a label map at the scale at which its floor is as large as was asked for.

    A sheet has no scale bar: the network knows it to some per cent. Walls stay as thick.
    """
    from chord_usd.base.scene.wish import floor_area_m2
    from chord_usd.line.planning.partition import plan_from_labels

    frame, bubbles = drawing.sheet.frame, drawing.bubbles
    plan = plan_from_labels(labels, frame, None, bubbles)
    if not plan.rooms:
        return plan
    wanted = (area_m2 / floor_area_m2(plan)) ** 0.5
    stretch = min(max(wanted, 1.0 - MOST_STRETCH), 1.0 + MOST_STRETCH)
    if abs(stretch - 1.0) < _SAME_LENGTH:
        return plan
    larger = replace(frame, m_per_px=frame.m_per_px * stretch)
    return plan_from_labels(labels, larger, None, stretched(bubbles, frame.origin_m, stretch))
