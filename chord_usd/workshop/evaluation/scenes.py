"""Any layout, by the planning table, the certificate where it is a stage, and POR."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.complete import homely_rooms
from chord_usd.base.metrics.design import COMPLETE, RIGHT, Design, Judged, design_of
from chord_usd.base.metrics.design.unsaid import FACTS, Fact, Said, Unjudged, unsaid_of
from chord_usd.base.metrics.scores import SceneScores, Score, mean_of, score_scene, share_of
from chord_usd.base.scene.types import SceneGraph
from chord_usd.workshop.data.foreign import Models, foreign_houses, stages_in

ReadStage = Callable[[Path], tuple[Sequence[SceneGraph], bool | None]]
"""The storeys of a stage, and whether its certificate holds; None where it was not certified."""
MOST_RULES = 5
"""Rules broken most often, by set, in the table; the JSON has all."""


@dataclass(frozen=True)
class Scene:
    """A layout as it was judged."""

    name: str
    unsaid: frozenset[Fact]
    design: Design
    unjudged: tuple[Unjudged, ...]
    scores: tuple[SceneScores, ...]
    """Of its storeys."""
    holds: bool | None = None
    """Whether the certificate holds; None for what is no stage."""

    @property
    def judged(self) -> tuple[Judged, ...]:
        """Rooms, tables and the home, where any rule was judged."""
        every = (*self.design.rooms, self.design.home)
        return tuple(judged for judged in every if judged.asked)


@dataclass(frozen=True)
class SceneSet:
    """The layouts of one source."""

    source: str
    scenes: tuple[Scene, ...]
    skipped: dict[str, str]
    """Why others could not be read, by name."""


def judge_scene(
    name: str, graphs: Sequence[SceneGraph], hidden: Iterable[Fact] = (), holds: bool | None = None
) -> Scene:
    """A layout by its storeys. hidden: facts that are not to be used even where they are said, as
    other sets leave them out."""
    unsaid = unsaid_of(graphs) | set(hidden)
    # Pieces in a window's niche are not beyond the room, whatever rules are judged.
    scores = tuple(score_scene(graph) for graph in graphs)
    graphs = [_without(graph, unsaid) for graph in graphs]
    said = Said(unsaid)
    homely = [room for graph in graphs for room in homely_rooms(graph)]
    design = design_of(graphs, homely, said)
    return Scene(name, unsaid, design, tuple(said.unjudged), scores, holds)


def _without(graph: SceneGraph, unsaid: frozenset[Fact]) -> SceneGraph:
    """The layout without openings of the kinds that are hidden."""
    kept = tuple(
        opening
        for opening in graph.openings
        if ("windows" if opening.kind == "window" else "doors") not in unsaid
    )
    return graph if len(kept) == len(graph.openings) else replace(graph, openings=kept)


def judged_sets(
    sources: Sequence[Path], models: Models, hidden: Iterable[Fact], read_stage: ReadStage
) -> Iterator[SceneSet]:
    """A set for each source; a folder may hold stages, or what foreign_houses reads."""
    hidden = tuple(hidden)
    for source in sources:
        scenes, skipped = [], {}
        for name, stage in stages_in(source):
            try:
                graphs, holds = read_stage(stage)
                scenes.append(judge_scene(name, graphs, hidden, holds))
            except ChordError as error:
                skipped[str(stage)] = str(error)
        if not scenes and not skipped:
            for name, house, why in foreign_houses(source, models):
                if house is None:
                    skipped[name] = why
                else:
                    scenes.append(judge_scene(name, [house], hidden))
        yield SceneSet(str(source), tuple(scenes), skipped)


# --- reports ---------------------------------------------------------------------------------


def kinds_of(scenes: Iterable[Scene]) -> dict[str, list[Judged]]:
    """What was judged by kind of room; tables and homes are kinds, too."""
    kinds: dict[str, list[Judged]] = {}
    for scene in scenes:
        for judged in scene.judged:
            kinds.setdefault(judged.kind, []).append(judged)
    return dict(sorted(kinds.items()))


def kept_share(judged: Sequence[Judged]) -> Score:
    """Rules kept / rules judged; a rule that a room breaks at several places counts once."""
    return share_of(
        sum(len(each.kept) for each in judged), sum(each.asked for each in judged), "rules"
    )


def _perfect(judged: Sequence[Judged]) -> Score:
    return share_of(sum(not each.findings for each in judged), len(judged), "rooms")


def broken_rules(judged: Sequence[Judged]) -> list[tuple[str, int, int]]:
    """(rule, rooms that break it, rooms where it was judged), the most broken first."""
    broken = Counter(rule for each in judged for rule in {_row(f.rule) for f in each.findings})
    kept = Counter(rule for each in judged for rule in each.kept)
    rows = [(rule, count, count + kept[rule]) for rule, count in broken.items()]
    return sorted(rows, key=lambda row: (-row[1] / row[2], -row[1], row[0]))


def _row(rule: str) -> str:
    """The row of the table: rows "complete" and "right" are followed by names of pieces."""
    return next((row for row in (COMPLETE, RIGHT) if rule.startswith(f"{row}, ")), rule)


def as_data(part: SceneSet) -> dict[str, Any]:
    """For --json."""
    scenes = part.scenes
    return {
        "source": part.source,
        "scenes": len(scenes),
        "skipped": part.skipped,
        "unsaid": _unsaid(scenes),
        "kinds": [
            {
                "kind": kind,
                "rooms": len(judged),
                "rules_kept": _score(kept_share(judged)),
                "rooms_that_keep_all": _score(_perfect(judged)),
                "broken": [
                    {"rule": rule, "rooms": count, "of": of}
                    for rule, count, of in broken_rules(judged)
                ],
            }
            for kind, judged in kinds_of(scenes).items()
        ],
        "rules_kept": _score(kept_share([each for scene in scenes for each in scene.judged])),
        "not_judged": _not_judged(scenes),
        **{name: _score(score) for name, score in _floor_scores(scenes).items()},
        "each": [_scene_data(scene) for scene in scenes],
    }


def _score(score: Score) -> dict[str, Any]:
    return {
        "value": round(score.value, 5) if score.count else None, "n": score.count,
        "over": score.over,
    }  # fmt: skip


def _scene_data(scene: Scene) -> dict[str, Any]:
    return {
        "name": scene.name,
        "certificate": scene.holds,
        "unsaid": sorted(scene.unsaid),
        "rules_kept": sum(len(judged.kept) for judged in scene.judged),
        "rules": sum(judged.asked for judged in scene.judged),
        "not_judged": len(scene.unjudged),
        "por": round(_por(scene), 6),
        "rooms": [judged.as_json() for judged in scene.judged],
    }


def _por(scene: Scene) -> float:
    pairs = sum(score.overlap.pairs for score in scene.scores)
    wrong = sum(score.overlap.por * score.overlap.pairs for score in scene.scores)
    return wrong / pairs if pairs else 0.0


def _unsaid(scenes: Sequence[Scene]) -> dict[Fact, int]:
    """How many layouts leave each fact out."""
    return {
        fact: count for fact in FACTS if (count := sum(fact in scene.unsaid for scene in scenes))
    }


def _not_judged(scenes: Sequence[Scene]) -> list[dict[str, Any]]:
    rows = Counter((each.kind, each.rule, each.facts) for s in scenes for each in s.unjudged)
    return [
        {"kind": kind, "rule": rule, "unsaid": list(facts), "rooms": count}
        for (kind, rule, facts), count in sorted(rows.items())
    ]


def _floor_scores(scenes: Sequence[Scene]) -> dict[str, Score]:
    """Scores of boxes on floors; of what a set leaves out there are none."""
    paired = [scene for scene in scenes if any(score.overlap.pairs for score in scene.scores)]
    sized = [scene for scene in paired if "sizes" not in scene.unsaid]
    walled = [scene for scene in scenes if not scene.unsaid & {"walls", "sizes"}]
    entered = [scene for scene in walled if "doors" not in scene.unsaid]
    certified = [scene for scene in scenes if scene.holds is not None]
    return {
        "por": mean_of([_por(scene) for scene in sized], "scenes with a pair of pieces"),
        "out_of_room": share_of(*_shares(walled, "out_of_room", "items"), "pieces"),
        "blocked_openings": share_of(*_shares(entered, "blocked_openings", "openings"), "openings"),
        "walkable": mean_of([s.walk.walkable for scene in walled for s in scene.scores], "storeys"),
        "reachable_rooms": mean_of(
            [s.walk.reachable_rooms for scene in entered for s in scene.scores], "storeys"
        ),
        "certificate": share_of(sum(bool(s.holds) for s in certified), len(certified), "stages"),
    }


def _shares(scenes: Sequence[Scene], culprits: str, whole: str) -> tuple[int, int]:
    scores = [score for scene in scenes for score in scene.scores]
    return (
        sum(len(getattr(score, culprits)) for score in scores),
        sum(getattr(score, whole) for score in scores),
    )


def as_markdown(parts: Sequence[SceneSet]) -> str:
    """A table by set and kind of room, then what was not judged and why, and what breaks most."""
    lines = [
        "| set | kind | n | rules kept | judged | keep all | not judged |",
        "|---|---|---|---|---|---|---|",
    ]
    for part in parts:
        for kind, judged in kinds_of(part.scenes).items():
            kept = kept_share(judged)
            left = sum(each.kind == kind for scene in part.scenes for each in scene.unjudged)
            lines.append(
                f"| {part.source} | {kind} | {len(judged)} | {_percent(kept)} | {kept.count} | "
                f"{_percent(_perfect(judged))} | {left} |"
            )
    lines += ["", "| set | score | value | n |", "|---|---|---|---|"]
    for part in parts:
        lines += [
            f"| {part.source} | {name} | {_value(score)} | {score.count} {score.over} |"
            for name, score in _floor_scores(part.scenes).items()
        ]
    for part in parts:
        lines += ["", f"{part.source}: {len(part.scenes)} layouts, {len(part.skipped)} unread"]
        lines += [
            f"- not judged, as {count} of {len(part.scenes)} do not say {FACTS[fact]}: "
            f"{_named(part.scenes, fact)}"
            for fact, count in _unsaid(part.scenes).items()
        ]
        for kind, judged in kinds_of(part.scenes).items():
            worst = broken_rules(judged)[:MOST_RULES]
            if worst:
                said = "; ".join(f"{rule} ({count} of {of})" for rule, count, of in worst)
                lines.append(f"- {kind}, broken most: {said}")
    return "\n".join(lines) + "\n"


def _named(scenes: Sequence[Scene], fact: Fact) -> str:
    names = Counter(each.rule for s in scenes for each in s.unjudged if fact in each.facts)
    return "; ".join(sorted(names)) or "no rule that any room was asked"


def _percent(score: Score) -> str:
    return f"{score.value:.1%}" if score.count else "not judged"


def _value(score: Score) -> str:
    return f"{score.value:.4f}" if score.count else "not judged"
