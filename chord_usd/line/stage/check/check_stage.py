"""StageFile -> Report: what `chord-usd check` says about a house (SceneEval, PhyScene, CHOrD).

Every figure is measured on the stage itself: rules on its prims, contact on its meshes, the rest
by chord_usd.base.metrics on the scene that is read back from it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pxr import Usd

from chord_usd.base.metrics import score_scene
from chord_usd.base.metrics.complete import Homely, Misplaced, home_lacks
from chord_usd.base.metrics.design import Design, design_of
from chord_usd.base.metrics.design.standard import Kept, Standard, keeping
from chord_usd.base.metrics.overlap import Overlap
from chord_usd.base.places.free_places import is_passage
from chord_usd.base.runtime.stages import open_known, open_stage, reading
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.line.stage.check.check_contact import Collision, collisions, unsupported
from chord_usd.line.stage.check.check_dressing import (
    Dressing,
    Objects,
    count_objects,
    measure_dressing,
)
from chord_usd.line.stage.check.check_held import Held, soft, underfoot
from chord_usd.line.stage.check.check_openables import Opens, openables
from chord_usd.line.stage.check.check_rules import (
    Finding,
    broken_by_files,
    broken_by_prims,
    in_order,
    validators_of,
)
from chord_usd.line.stage.check.check_scene import StageScene, read_storeys
from chord_usd.line.stage.check.check_stairs import stage_walks, stair_faults
from chord_usd.line.stage.read.leaf_states import shut_leaves


@dataclass(frozen=True)
class Outlier:
    """How far from the layout model's expectation an item is (layout.outlier)."""

    path: str
    score: float
    """0 for what it would paint exactly so, about 1 for what it would not have put there."""


@dataclass(frozen=True)
class Missing:
    """Advice: what a room cannot do without and does not have."""

    path: str
    pieces: tuple[str, ...]
    """The most needed first."""


@dataclass(frozen=True)
class Unreachable:
    """A room that no way leads to from the entrance."""

    path: str
    shut_by: Literal["furniture", "plan"]
    """The plan where the empty house has no way in, either."""


_SHUT_BY = {"furniture": "pieces shut the way to it", "plan": "the plan gives it no way in"}


@dataclass(frozen=True)
class Report:
    """What is wrong with a stage, and how good it is. Paths are prim paths."""

    errors: tuple[Finding, ...]
    collisions: tuple[Collision, ...]
    out_of_room: tuple[str, ...]
    blocked_openings: tuple[str, ...]
    unsupported: tuple[str, ...]
    empty_rooms: tuple[str, ...]
    walkable: float
    reachable_rooms: float
    por: float
    piou: float
    pairs: int
    ood: tuple[Outlier, ...]
    """Items that the layout model was asked about, the least expected first."""
    complete: float
    """Share of the rooms judged that have what their kind cannot do without; 1 without any."""
    right: float
    """The same share, of rooms in which nothing stands wrongly, too."""
    missing: tuple[Missing, ...]
    home_lacks: tuple[str, ...]
    """What no home is without, such as a cooker, and is in none of its rooms."""
    misplaced: tuple[Misplaced, ...]
    objects: Objects
    dressing: Dressing
    design: Design
    """Planning rules that rooms and home keep, and what breaks others: advice, too."""
    stairs: tuple[str, ...] = ()
    """Stairs that cannot be walked, and why."""
    unreachable: tuple[Unreachable, ...] = ()
    opens: tuple[Opens, ...] = ()
    """Doors, drawers, flaps and lids of furniture, and how far they open."""
    standards: tuple[Kept, ...] = ()
    """Standards that the report was asked for."""

    @property
    def shut(self) -> tuple[Opens, ...]:
        """What something stops before it is open."""
        return tuple(leaf for leaf in self.opens if not leaf.is_free)

    @property
    def faults(self) -> tuple[str, ...]:
        """What the certificate does not hold for, a line each that begins with a prim path."""
        return (
            *(f"{error.path}: {error.message} ({error.rule})" for error in self.errors),
            *(f"{a.a} runs into {a.b} by {a.depth_m * 100:.1f} cm" for a in self.collisions),
            *(f"{path} is out of its room" for path in self.out_of_room),
            *(f"{path} is blocked" for path in self.blocked_openings),
            *(f"{path} stands on nothing" for path in self.unsupported),
            *(f"{room} is empty" for room in self.empty_rooms),
            *self.stairs,
            *(f"{room.path} cannot be reached: {_SHUT_BY[room.shut_by]}"
              for room in self.unreachable),
            *(f"{leaf.path} does not open: {leaf.stopped_by} stops it at {leaf.free}"
              for leaf in self.opens if leaf.is_stuck),
        )  # fmt: skip

    @property
    def flaws(self) -> tuple[str, ...]:
        """What is not right in rooms and in the home, a line each: advice, no fault."""
        return (
            *(f"{room.path} lacks {piece}" for room in self.missing for piece in room.pieces),
            *(f"{case.item} is {case.fault}" for case in self.misplaced),
            *(f"the home has no {piece}" for piece in self.home_lacks),
            *(f"{leaf.path} opens {leaf.free}: {leaf.stopped_by} stops it"
              for leaf in self.shut if not leaf.is_stuck),
        )  # fmt: skip

    @property
    def holds(self) -> bool:
        """Whether the certificate holds: a valid stage of a house in which nothing is amiss.

        A room out of reach is amiss, whether furniture shuts it or the plan gives it no way in.
        walkable, por, piou and ood are scores, not conditions: they also judge the plan, which is
        given. What is missing or misplaced is advice. A room in which nothing fits without shutting
        a door is a passage of the plan, and stays empty.
        """
        return not self.faults

    @property
    def valid(self) -> bool:
        """The same as holds, under its name of earlier versions; goes in the next one."""
        return self.holds


def worse(before: Report, after: Report) -> tuple[str, ...]:
    """What a change of a house makes worse: faults and flaws of after that before has not."""
    known = {*before.faults, *before.flaws}
    return tuple(line for line in (*after.faults, *after.flaws) if line not in known)


def check_stage(path: Path, *, trusted: bool = False, standards: Sequence[Standard] = ()) -> Report:
    """Check a stage. Raises StageError for a file that cannot be opened.

    trusted: whether this process wrote it; other files are searched for harm first. standards: to
    compare the home with, beside the certificate.
    """
    with reading(path):
        stage = open_known(path) if trusted else open_stage(path)
        shut_leaves(stage)
        return _reported(stage, standards)


def _reported(stage: Usd.Stage, standards: Sequence[Standard]) -> Report:
    with ThreadPoolExecutor(1) as beside:
        of_files = beside.submit(broken_by_files, stage, validators_of(stage))
        of_prims = broken_by_prims(stage)
        report = _measured(stage, standards)
        findings = in_order([*of_files.result(), *of_prims])
    return replace(report, errors=(*findings, *report.errors))


def _measured(stage: Usd.Stage, standards: Sequence[Standard]) -> Report:
    """The report, of broken rules with CHORD015 only."""
    storeys = read_storeys(stage)
    roomless = Finding("CHORD015", "/", "has no room with a floor below its Rooms")
    errors = () if any(scene.graph.rooms for scene in storeys) else (roomless,)
    scores = [score_scene(scene.graph) for scene in storeys]
    faults = stair_faults(storeys)
    walks = stage_walks(storeys, faults) if len(storeys) > 1 else [score.walk for score in scores]
    overlap = Overlap(
        sum(score.overlap.pairs for score in scores),
        tuple(pair for score in scores for pair in score.overlap.overlapping),
    )
    whole = _together(storeys)
    return Report(
        errors=errors,
        collisions=tuple(hit for scene in storeys for hit in _collisions(scene)),
        out_of_room=tuple(path for score in scores for path in score.out_of_room),
        blocked_openings=tuple(path for score in scores for path in score.blocked_openings),
        unsupported=tuple(
            path
            for scene in storeys
            for path in unsupported(scene.items, scene.ground, Held(scene))
        ),
        empty_rooms=tuple(room for scene, score in zip(storeys, scores, strict=True)
                          for room in score.empty_rooms if not is_passage(scene.graph, room)),
        walkable=_share(sum(walk.walkable * walk.walkable_m2 for walk in walks),
                        sum(walk.walkable_m2 for walk in walks)),
        reachable_rooms=1.0 - _share(sum(len(walk.unreachable) for walk in walks),
                                     sum(walk.rooms for walk in walks)),
        por=overlap.por,
        piou=overlap.piou,
        pairs=overlap.pairs,
        ood=_outliers(whole.items),
        **_advice([room for score in scores for room in score.homely]),
        home_lacks=home_lacks(whole.items),
        objects=count_objects(whole),
        dressing=measure_dressing(stage, storeys),
        design=design_of([scene.entered_graph for scene in storeys],
                         [room for score in scores for room in score.homely]),
        stairs=tuple(f"{path} {fault}" for path, fault in faults.items()),
        unreachable=tuple(
            Unreachable(room, "plan" if room in way.doorless else "furniture")
            for way in walks for room in way.unreachable
        ),
        opens=tuple(leaf for scene in storeys for leaf in openables(stage, scene)),
        standards=tuple(keeping(standard, [scene.entered_graph for scene in storeys])
                        for standard in standards),
    )  # fmt: skip


def _collisions(scene: StageScene) -> list[Collision]:
    dressing = scene.graph.dressing
    return collisions(scene.items, scene.fixed, underfoot(dressing), soft(dressing))


def _together(storeys: Sequence[StageScene]) -> SceneGraph:
    """All storeys as one graph, to count its contents; places stay in the frame of each storey."""
    graphs = [scene.graph for scene in storeys]
    return SceneGraph(
        tuple(room for graph in graphs for room in graph.rooms),
        tuple(opening for graph in graphs for opening in graph.openings),
        tuple(item for graph in graphs for item in graph.items),
        dressing=tuple(item for graph in graphs for item in graph.dressing),
    )


def _share(part: float, whole: float) -> float:
    return part / whole if whole else 0.0


def _advice(rooms: Sequence[Homely]) -> dict[str, Any]:
    judged = max(1, len(rooms))
    return {
        "complete": 1.0 - sum(not room.complete for room in rooms) / judged,
        "right": 1.0 - sum(not room.right for room in rooms) / judged,
        "missing": tuple(Missing(room.room, room.missing) for room in rooms if room.missing),
        "misplaced": tuple(piece for room in rooms for piece in room.misplaced),
    }


def _outliers(items: Iterable[Item]) -> tuple[Outlier, ...]:
    asked = [Outlier(item.id, score) for item in items if (score := item.facts.ood) is not None]
    return tuple(sorted(asked, key=lambda outlier: -outlier.score))


def certificate(report: Report) -> dict[str, Any]:
    """The report as `--json` gives it."""
    fields = {
        key: list(value) if isinstance(value, tuple) else value
        for key, value in asdict(report).items()
    }
    fields["design"] = {
        "rules_kept": round(report.design.share, 4),
        "rooms": [room.as_json() for room in report.design.rooms],
        "home": report.design.home.as_json(),
    }
    fields["opens"] = [asdict(leaf) for leaf in report.opens]
    fields["standards"] = [standard.as_json() for standard in report.standards]
    return {"holds": report.holds, "valid": report.valid, **fields, "faults": list(report.faults)}
