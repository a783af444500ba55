"""What each rule after the draw is worth: every house read, arranged and scored without it.

    python benchmarks/rules.py [--houses N] [--flats JSONL] [--write]

One layout is sampled of each held-out plan; then it is read once with all rules, once with none,
and once without each. "acts" is the share of houses that the rule changes. A rule that is worth
less than half a percent of the rooms, and no error of the stage, can go.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from results import write_section

from chord_usd.base.metrics.scores import SceneScores, score_scene
from chord_usd.base.scene.types import LayoutImage, Plan, SceneGraph
from chord_usd.line import pipeline
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import RULES, arrange
from chord_usd.line.pipeline.redraw import Draw, arrange_drawn
from chord_usd.workshop.evaluation.cases import Case, flat_cases, procedural_cases
from chord_usd.workshop.evaluation.layouts import Furnished, Sampling, sampled

BUILDING: Mapping[str, Callable[[SceneGraph], SceneGraph]] = {
    "what stands in the way left out": lambda graph: arrange_drawn(graph, Draw()),
    "panels on walls, chairs clear of tables": lambda graph: arrange(
        Arrangement.of(graph), "meshed"
    ),
}
"""Steps of the pipeline after reading."""


def _arranged(
    layout: LayoutImage, plan: Plan, reader: pipeline.GraphReader, out: Sequence[str]
) -> SceneGraph:
    """Read and arranged as generate does, without some rules and without second draws."""
    graph = replace(reader, without=frozenset(out)).read(layout, plan)
    for name, step in BUILDING.items():
        if name not in out:
            graph = step(graph)
    return graph


def _row(scores: Sequence[SceneScores]) -> dict[str, float]:
    """complete and right of rooms, then of houses; POR, PIoU; openings blocked."""
    rooms = [one for score in scores for one in score.homely]
    return {
        "complete": float(np.mean([not one.missing for one in rooms])),
        "right": float(np.mean([not one.missing and not one.misplaced for one in rooms])),
        "houses": float(np.mean([not any(o.missing for o in s.homely) for s in scores])),
        "POR": float(np.mean([score.overlap.por for score in scores])),
        "PIoU": float(np.mean([score.overlap.piou for score in scores])),
        "outside": sum(len(s.out_of_room) for s in scores) / sum(s.items for s in scores),
        "blocked": sum(len(s.blocked_openings) for s in scores) / sum(s.openings for s in scores),
        "walkable": float(np.mean([score.walk.walkable for score in scores])),
        "items": float(np.mean([score.items for score in scores])),
    }


def main() -> None:
    """Measures; with --write also into benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--houses", type=int, default=100)
    parser.add_argument("--flats", type=Path, help="real floor plans instead of procedural ones")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    cases = _cases(options.houses, options.flats)
    settings = pipeline.Settings()
    reader, model = pipeline.load_reader(settings), pipeline.load_model(settings)
    lists = pipeline.load_lists(settings, model)
    made = list(sampled(model, cases, Sampling(), lists))
    whole = _graphs(made, reader, ())
    names = (*(rule.name for rule in RULES if rule.when == "read"), *BUILDING)
    rows = [("", " | ".join(_row([score_scene(whole[0])])) + " | acts")]
    rows.append(("all rules", _told(whole)))
    for name in names:
        rows.append((f"without: {name}", _told(_graphs(made, reader, (name,)), whole)))
        sys.stderr.write(f"{rows[-1][0]} | {rows[-1][1]}\n")
    rows.append(("none", _told(_graphs(made, reader, names), whole)))
    kind = "real flats" if options.flats else "procedural houses"
    note = f"{len(cases)} held-out {kind}, one draw each; rooms but where it says houses."
    if options.write:
        sys.stdout.write(write_section(f"rules after the draw, {kind}", rows, note))
    else:
        sys.stdout.write("\n".join(f"{name} | {value}" for name, value in rows) + f"\n{note}\n")


def _cases(count: int, flats: Path | None) -> Sequence[Case]:
    found = flat_cases(flats, "test", count) if flats else procedural_cases("test", count)
    return found.cases


def _graphs(
    made: Sequence[Furnished], reader: pipeline.GraphReader, out: Sequence[str]
) -> list[SceneGraph]:
    return [_arranged(one.image, one.case.plan, reader, out) for one in made]


def _told(graphs: Sequence[SceneGraph], whole: Sequence[SceneGraph] | None = None) -> str:
    figures = [f"{value:.3g}" for value in _row([score_scene(graph) for graph in graphs]).values()]
    if whole:
        changed = [_boxes(a) != _boxes(b) for a, b in zip(graphs, whole, strict=True)]
        figures.append(f"{np.mean(changed):.2f}")
    return " | ".join(figures)


def _boxes(graph: SceneGraph) -> list[tuple[str, object]]:
    return [(item.category, item.box) for item in graph.items]


if __name__ == "__main__":
    main()
