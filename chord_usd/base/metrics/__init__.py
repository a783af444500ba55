"""Scores of scenes, each defined in one place.

    overlap    POR and PIoU, the paper's collision scores
    rooms      items out of their room, rooms left empty
    complete   rooms that hold what their kind cannot do without, standing rightly
    openings   doors, windows and passages with something in front of them
    walk       walkable floor, rooms one can reach
    fidelity   plans, orientations and rasters against the truth
    detection  average precision of proposals, errors of edges
    scores     all of these for a scene, and means over a set

Numpy and shapely only. Every mean carries its sample count and denominator (scores.Score).
"""

from chord_usd.base.metrics.scores import (
    SceneScores,
    Score,
    mean_scores,
    part_of,
    rooms_of_kind,
    score_scene,
    score_scenes,
)

__all__ = [
    "SceneScores",
    "Score",
    "mean_scores",
    "part_of",
    "rooms_of_kind",
    "score_scene",
    "score_scenes",
]
