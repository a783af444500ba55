"""evaluate: checkpoints and held-out plans -> scores, a module per verb."""

from __future__ import annotations

from chord_usd.faces.commands import (
    evaluate_detector,
    evaluate_diversity,
    evaluate_floors,
    evaluate_layouts,
    evaluate_ood,
    evaluate_plans,
    evaluate_scenes,
    evaluate_speed,
    evaluate_tabletops,
)
from chord_usd.faces.commands.common import Verbs, add_group

VERBS = (
    evaluate_layouts, evaluate_ood, evaluate_speed, evaluate_diversity, evaluate_detector,
    evaluate_plans, evaluate_tabletops, evaluate_floors,
    evaluate_scenes,
)  # fmt: skip


def add(verbs: Verbs) -> None:
    """Adds the verbs."""
    group = add_group(verbs, "evaluate", "score checkpoints on held-out data")
    for verb in VERBS:
        verb.add(group)
