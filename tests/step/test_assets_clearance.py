"""What opens keeps 3 mm free on its whole way, beside neighbours that stand flush."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import mujoco
import numpy as np
import pytest

from chord_usd.library.catalogue import designs
from chord_usd.library.kit.leaf_clearance import CLEAR_M
from chord_usd.library.kit.links import Link, links_of, opens
from chord_usd.library.kit.model import Design
from chord_usd.library.kit.moves import Hinge
from chord_usd.line.stage.check.pulled import shares
from tests.design_forms import ends
from tests.every import for_every

STEPS = 41
NEIGHBOUR_M = 1.0
ROUNDING_M = 1e-6


def corners(bounds: np.ndarray) -> np.ndarray:
    """(8, 3) of a box, (2, 3)."""
    return np.stack(np.meshgrid(*bounds.T, indexing="ij"), axis=-1).reshape(8, 3)


def on_the_way(link: Link, box: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a box, (S, 8, 3), on the way of its joint, and its axes, (S, 3, 3) rows."""
    motion = link.motion
    axis = "xyz".index(motion.axis)
    turns = np.repeat(np.eye(3)[None], STEPS, axis=0)
    if not isinstance(motion, Hinge):
        ways = np.linspace(0.0, motion.opens_m, STEPS)
        return corners(box) + ways[:, None, None] * np.eye(3)[axis], turns
    first, second = (axis + 1) % 3, (axis + 2) % 3
    angles = np.radians(np.linspace(0.0, motion.opens_deg, STEPS))
    turns[:, first, first] = turns[:, second, second] = np.cos(angles)
    turns[:, second, first] = -np.sin(angles)
    turns[:, first, second] = np.sin(angles)
    return (corners(box) - motion.at_m) @ turns + motion.at_m, turns


def gap_m(points: np.ndarray, axes: np.ndarray, boxes: np.ndarray) -> float:
    """The least gap, by separating axes, between turned boxes and upright ones, (N, 2, 3)."""
    upright = np.repeat(np.eye(3)[None], len(axes), axis=0)
    directions = np.concatenate([upright, axes], axis=1).swapaxes(1, 2)
    mine = (points @ directions)[:, None]
    theirs = np.stack([corners(box) for box in boxes]) @ directions[:, None]
    apart = np.maximum(theirs.min(axis=2) - mine.max(axis=2), mine.min(axis=2) - theirs.max(axis=2))
    return float(apart.max(axis=2).min())


def neighbours(design: Design, face_y: float) -> np.ndarray:
    """(2, 2, 3) boxes on both sides of a piece, flush with a face."""
    length, width, height = design.size_m
    near, far = length / 2, length / 2 + NEIGHBOUR_M
    return np.array([
        [[near, face_y, 0.0], [far, width / 2, height]],
        [[-far, face_y, 0.0], [-near, width / 2, height]],
    ])  # fmt: skip


def least_gap_m(design: Design) -> float:
    """The least that any leaf of a design keeps free to what is beside it and behind it."""
    parts = design.parts()
    base, *leaves = links_of(parts)
    still = [box for piece in base.pieces for box in piece.colliders_m]
    fronts = {link.name: link.pieces[0].colliders_m for link in leaves}
    least = np.inf
    for link in leaves:
        others = [box for name, boxes in fronts.items() if name != link.name for box in boxes]
        for box in fronts[link.name]:
            beside = neighbours(design, float(box[0, 1]))
            fixed = np.array([*still, *others, *beside])
            least = min(least, gap_m(*on_the_way(link, box), fixed))
    return least


@for_every("design", ends(designs()), ids=lambda design: design.id, step=4)
def test_leaves_keep_3_mm_free_on_their_whole_way(design: Design) -> None:
    """On all designs: before, leaves of refrigerators swept 3 mm into flush neighbours."""
    assert not opens(design.parts()) or least_gap_m(design) >= CLEAR_M - ROUNDING_M


@pytest.mark.parametrize(
    "design", [one for one in ends(designs()) if one.category == "refrigerator"], ids=lambda d: d.id
)
def test_a_refrigerator_between_flush_neighbours_is_pulled_open(
    design: Design, puller: ModuleType, tmp_path: Path
) -> None:
    spec = puller.jointed_spec(puller.written(design, tmp_path))
    face_y = min(box[0, 1] for box in links_of(design.parts())[1].pieces[0].colliders_m)
    for box in neighbours(design, face_y):
        size, middle = np.ptp(box, axis=0) / 2, box.mean(axis=0)
        spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=middle)
    model = spec.compile()
    opened = [share for _, share in shares(model)]
    assert len(opened) == model.njnt
    assert min(opened) >= 0.9
