"""Scores of first samples: what the model painted, read back; and the same arranged, beside.

Reading snaps edges within half a pixel of a wall or of each other, and moves nothing else.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.complete import ESSENTIALS
from chord_usd.base.metrics.fidelity import F1, plan_fidelity
from chord_usd.base.metrics.rooms import empty_rooms, is_to_furnish
from chord_usd.base.metrics.scores import (
    Score,
    homely_house_scores,
    homely_scores,
    mean_scores,
    rooms_of_kind,
    score_scene,
    score_scenes,
)
from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Progress, Warn
from chord_usd.base.scene.types import (
    ByteArray,
    Detection,
    LayoutImage,
    Plan,
    PlanImage,
    RoomKind,
    SceneGraph,
)
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import arrange
from chord_usd.line.graph.extract import extract_graph
from chord_usd.line.layout.config import LayoutConfig
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.draft import Draft
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.lists.house import Drafts, furnish_by_lists
from chord_usd.line.lists.list_sampler import Drawer, ListDrawer
from chord_usd.line.pipeline.redraw import Draw
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.data.statistics import total_variation
from chord_usd.workshop.evaluation.cases import Case

MUST_FURNISH: tuple[RoomKind, ...] = ("living", "bedroom", "kitchen", "bathroom")
"""A house is furnished when none of these stands empty."""

JUDGED: tuple[RoomKind, ...] = tuple(ESSENTIALS)
"""Kinds of room with a column of their own."""

ARRANGED = "house, arranged"
"""The row of whole houses after the rules that follow reading."""

BATCH = 8


@dataclass(frozen=True)
class Sampling:
    """How layouts are sampled."""

    seed: int = 0
    steps: int | None = None
    """None takes what the checkpoint was tuned for."""
    sampler: str | None = None
    """None takes the checkpoint's own."""
    shaded: bool = True
    """Whether the plan shows the kind of its rooms."""

    def settled(self, config: LayoutConfig) -> Sampling:
        """With what a checkpoint was tuned for where nothing else is asked."""
        return replace(
            self,
            steps=self.steps or config.default_steps,
            sampler=self.sampler or config.default_sampler,
        )


@dataclass(frozen=True, eq=False)
class Furnished:
    """A case with its layout and the scene that is to be scored."""

    case: Case
    image: LayoutImage
    scene: SceneGraph
    """Nothing moved: edges alone that lie half a pixel from a wall or neighbour are on it."""
    arranged: SceneGraph | None = None
    """After the rules of arrange.rules; None where no model made it."""
    read_plan: Plan | None = None
    """Rooms and openings as one reads them off the image; None where none is."""


@dataclass(frozen=True)
class LayoutScores:
    """One evaluation: a row of scores per part of the house, and what they were measured on."""

    rows: dict[str, dict[str, Score]]
    """By part: house, bedroom, living, ...; then by score name."""
    split: str
    made_by: str
    """Hash of the checkpoint, or who else made the layouts."""
    steps: int
    """Of the sampler; 0 where no model made them."""
    sampler: str


def sampled(
    model: LayoutModel,
    cases: Sequence[Case],
    sampling: Sampling,
    lists: ListDrawer | None = None,
    progress: Progress | None = None,
    warn: Warn | None = None,
) -> Iterator[Furnished]:
    """Samples a layout for every plan and reads the items back; rooms come from the plan.

    Case i gets the seed of sampling plus i. lists: what the model starts from. warn is called where
    memory ended and the batch was halved.
    """
    jobs = [_job(case, sampling, index, lists) for index, case in enumerate(cases)]

    def work(part: Sequence[_Job]) -> list[LayoutImage]:
        return model.sample_batch(
            [job.image for job in part],
            seeds=[job.draw.seed for job in part],
            steps=sampling.steps,
            sampler=sampling.sampler,
            drafts=[job.draft for job in part],
        )

    for index, image in enumerate(in_batches(work, jobs, BATCH, warn)):
        yield read_back(cases[index], image)
        if progress:
            progress(index + 1, len(cases))


class _Job(NamedTuple):
    """What a layout is sampled from."""

    image: PlanImage
    draw: Draw
    draft: Draft | None


def _job(case: Case, sampling: Sampling, index: int, lists: ListDrawer | None) -> _Job:
    image = _plan_image(case, sampling)
    draw = Draw(sampling.seed + index, sampling.steps, sampling.sampler, lists)
    listed = draw.listed(case.plan.scene(), case.plan.rooms)
    draft = Draft.of(listed.items, listed.rooms, image.frame) if listed else None
    return _Job(image, draw, draft)


def _plan_image(case: Case, sampling: Sampling) -> PlanImage:
    return canvas.draw_plan(case.plan, canvas.house_frame(case.plan), shade=sampling.shaded)


def read_back(case: Case, image: LayoutImage) -> Furnished:
    """The items of a layout in the rooms of its plan, and the plan as the layout shows it."""
    scene = extract_graph(image, plan=case.plan)
    try:
        plan = extract_graph(image, detector=_Blind()).plan
    except SceneError:
        plan = None
    return Furnished(case, image, scene, arrange(Arrangement.read_from(image, scene), "read"), plan)


def made_by(model: LayoutModel, lists: ListDrawer | None) -> str:
    """The hashes of what samples layouts, for reports."""
    return model.checkpoint.content_hash + (f" from lists of {lists.content_hash}" if lists else "")


def drawn(cases: Iterable[Case], sampling: Sampling) -> Iterator[Furnished]:
    """The furniture a case comes with or, without any, what the furnisher puts in, as it is.

    The score to reach, and how anybody's layouts in CHOrD JSON are scored.
    """
    for case in cases:
        scene = case.truth(sampling.seed)
        plan_image = _plan_image(case, sampling)
        yield Furnished(case, canvas.layout_image(plan_image, scene.items), scene)


def listed(
    drawer: Drawer, cases: Iterable[Case], sampling: Sampling, drafts: int
) -> Iterator[Furnished]:
    """What lists, or boxes, alone put in, nothing painted. Case i gets that seed plus i.

    drafts: of each room, of which the best is taken.
    """
    for index, case in enumerate(cases):
        scene = furnish_by_lists(case.plan, drawer, Drafts(sampling.seed + index, drafts))
        plan_image = _plan_image(case, sampling)
        yield Furnished(case, canvas.layout_image(plan_image, scene.items), scene)


def as_read(layout: Furnished, sampling: Sampling) -> Furnished:
    """With the picture that its items give: the layout without what reading it evens out.

    sampling: as it was made.
    """
    plan_image = _plan_image(layout.case, sampling)
    return replace(layout, image=canvas.layout_image(plan_image, layout.scene.items))


class _Blind:
    """A detector that proposes nothing: for reading plans."""

    def detect(self, rgb: ByteArray) -> list[Detection]:
        return []


def score_layouts(furnished: Sequence[Furnished], made_by: str, sampling: Sampling) -> LayoutScores:
    """All rows of the table for these layouts, whole houses and rooms by kind.

    sampling: as they were made; settled, or without steps where no model made them.
    """
    scenes = [layout.scene for layout in furnished]
    scores = [score_scene(scene) for scene in scenes]
    homely = [score.homely for score in scores]
    rows = {
        "house": {
            **mean_scores(scores), **homely_house_scores(homely), **_house_scores(scenes),
            **_fidelity(furnished),
        }
    }  # fmt: skip
    arranged = [layout.arranged for layout in furnished if layout.arranged]
    if arranged:
        final = [score_scene(scene) for scene in arranged]
        homely = [score.homely for score in final]
        rows[ARRANGED] = {
            **mean_scores(final), **homely_house_scores(homely), **_house_scores(arranged)
        }  # fmt: skip
    for kind in JUDGED:
        # What stands at an open side is judged by what lies beyond it.
        rows[kind] = score_scenes(rooms_of_kind(scenes, kind)) | homely_scores(homely, kind)
    cases = [layout.case for layout in furnished]
    for part, part_scores in piece_scores(scenes, cases, JUDGED, MUST_FURNISH).items():
        rows[part or "house"].update(part_scores)
    return LayoutScores(
        rows=rows,
        split=split_hash(layout.case.id for layout in furnished),
        made_by=made_by,
        steps=sampling.steps or 0,
        sampler=sampling.sampler or "",
    )


def _house_scores(scenes: Sequence[SceneGraph]) -> dict[str, Score]:
    furnished = [is_furnished(scene) for scene in scenes]
    counts = [len(scene.items) for scene in scenes]
    return {
        "furnished_houses": Score(float(np.mean(furnished)), len(scenes), "houses"),
        "items_per_house": Score(float(np.mean(counts)), len(scenes), "houses"),
    }


def is_furnished(scene: SceneGraph) -> bool:
    """Whether no room of MUST_FURNISH stands empty."""
    empty = set(empty_rooms(scene))
    return not any(
        room.id in empty
        for room in scene.rooms
        if room.kind in MUST_FURNISH and is_to_furnish(room)
    )


def _fidelity(furnished: Sequence[Furnished]) -> dict[str, Score]:
    """Plan fidelity of the pictures, and how many items show where their front is."""
    read = [layout for layout in furnished if layout.image.provenance.checkpoint_hash]
    if not read:
        return {}
    plans = [
        plan_fidelity(layout.read_plan, layout.case.plan) for layout in read if layout.read_plan
    ]
    lost = len(read) - len(plans)
    scores = {
        "plan_walls_f1": _summed([plan.walls for plan in plans], "m of wall faces"),
        "plan_doors_f1": _summed([plan.doors for plan in plans], "doors"),
        "plan_windows_f1": _summed([plan.windows for plan in plans], "windows"),
    }
    ious = [plan.room_iou for plan in plans] + [0.0] * lost
    scores["plan_room_iou"] = Score(float(np.mean(ious)), len(ious), "houses")
    fronts = [item.facts.front_from for layout in read for item in layout.scene.items]
    shown = fronts.count("mark")
    scores["front_shown"] = Score(shown / max(len(fronts), 1), len(fronts), "items")
    return scores


def _summed(parts: Sequence[F1], over: str) -> Score:
    """F1 over all houses together, so that a house without a door weighs nothing."""
    total = F1(
        sum(part.read for part in parts),
        sum(part.truth for part in parts),
        sum(part.read_matched for part in parts),
        sum(part.truth_matched for part in parts),
    )
    return Score(total.value, round(total.truth), over)


# How many pieces rooms have, beside what the data's own furnisher puts into the same -------------

_SEEDS = (1, 2)
"""Of the furnisher: what two of its own furnishings differ by is what chance alone gives."""


def piece_scores(
    scenes: Sequence[SceneGraph],
    cases: Sequence[Case],
    kinds: Sequence[RoomKind],
    median_of: Sequence[RoomKind],
) -> dict[RoomKind | None, dict[str, Score]]:
    """The median number of pieces a room, and the total variation between the histograms of these
    numbers here and in the data, for each kind of room; under None over all kinds, by their rooms.

    pieces_tv_floor: between two furnishings of the data. median_of: of kinds, those that the median
    over all looks at.
    """
    mine = _counts(scenes, kinds)
    data, again = (
        _counts((case.truth(seed) for case in cases if case.furnished is None), kinds)
        for seed in _SEEDS
    )
    rows: dict[RoomKind | None, dict[str, Score]] = {}
    for kind in kinds:
        rows[kind] = {
            "pieces_median": _median(mine[kind]),
            "pieces_tv": _variation(mine[kind], data[kind]),
            "pieces_tv_floor": _variation(again[kind], data[kind]),
        }
    together = sum((mine[kind] for kind in median_of), Counter[int]())
    whole = {"pieces_median": _median(together)}
    for name in ("pieces_tv", "pieces_tv_floor"):
        whole[name] = _mean([rows[kind][name] for kind in kinds])
    return {None: whole, **rows}


def _counts(
    scenes: Iterable[SceneGraph], kinds: Sequence[RoomKind]
) -> dict[RoomKind, Counter[int]]:
    """By kind, how many rooms have how many pieces."""
    counts: dict[RoomKind, Counter[int]] = {kind: Counter() for kind in kinds}
    for scene in scenes:
        pieces = Counter(item.room_id for item in scene.items)
        for room in scene.rooms:
            if room.kind in counts:
                counts[room.kind][pieces[room.id]] += 1
    return counts


def _median(counts: Counter[int]) -> Score:
    rooms = sorted(counts.elements())
    return Score(float(np.median(rooms)) if rooms else 0.0, len(rooms), "rooms")


def _variation(mine: Counter[int], data: Counter[int]) -> Score:
    known = mine.total() if data else 0
    return Score(total_variation(mine, data) if known else 0.0, known, "rooms")


def _mean(scores: Sequence[Score]) -> Score:
    """By rooms."""
    rooms = sum(score.count for score in scores)
    total = sum(score.value * score.count for score in scores)
    return Score(total / rooms if rooms else 0.0, rooms, "rooms")
