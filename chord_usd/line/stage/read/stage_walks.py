"""How far one gets on foot in a house on its stage: for the certificate and for robots."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from chord_usd.base.metrics.walk import Ascent, Walk, walk_storeys
from chord_usd.line.stage.check.check_scene import StageScene


def stage_walks(storeys: Sequence[StageScene], faulty: Collection[str] = ()) -> list[Walk]:
    """On each storey, over the stairs that can be walked. faulty: paths of stairs that cannot."""
    ascents = [
        Ascent(index, tuple(stair.walk_m[0, :2].tolist()), tuple(stair.walk_m[-1, :2].tolist()))
        for index, scene in enumerate(storeys[:-1])
        for stair in scene.stairs
        if stair.body.path not in faulty
    ]  # fmt: skip
    return walk_storeys([scene.entered_graph for scene in storeys], ascents)
