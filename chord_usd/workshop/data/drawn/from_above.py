"""Our own furniture seen from above, as brochures show it: meshes, shaded, cached as pictures."""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np

from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.types import Box, ByteArray, FloatArray, Item
from chord_usd.library.catalogue import designs
from chord_usd.library.kit.model import Design
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas

_PX_PER_M = 64
_FINE_BITS = 4
_CHOICES = 3
"""Designs of the nearest size of which one is drawn."""


def draw_from_above(
    canvas: Canvas, item: Item, rng: np.random.Generator, *, has_shadow: bool
) -> bool:
    """Lay the picture of a piece on the canvas; False where there is none of its category."""
    near = _nearest(item.category, round(item.box.size_m[0], 1), round(item.box.size_m[1], 1))
    if not near:
        return False
    design = near[int(rng.integers(len(near)))]
    colourways = sorted(design.colourways)
    picture = _picture(design.id, design.category, colourways[int(rng.integers(len(colourways)))])
    if has_shadow:
        shade = np.zeros_like(picture)
        shade[..., 3] = cv2.blur(picture[..., 3], (7, 7)) // 3
        _lay(canvas, shade, item.box, np.array([0.05, -0.05]))
    _lay(canvas, picture, item.box, np.zeros(2))
    return True


def _lay(canvas: Canvas, picture: ByteArray, box: Box, shift_m: FloatArray) -> None:
    """Stretch a picture, (h, w, 4), back edge up, over a box's footprint."""
    height, width = picture.shape[:2]
    # Back left, front left and front right.
    target = canvas.px(footprint(box)[:3] + shift_m) - 0.5
    low = np.floor(target.min(axis=0)).astype(int) - 1
    far = canvas.px(footprint(box) + shift_m).max(axis=0)
    size = np.ceil(far).astype(int) + 2 - low
    source = np.array([[0, 0], [0, height], [width, height]], np.float32) - 0.5
    matrix = cv2.getAffineTransform(source, (target - low).astype(np.float32))
    wide, tall = size.tolist()
    placed = np.asarray(
        cv2.warpAffine(picture, matrix, (wide, tall), flags=cv2.INTER_AREA), np.uint8
    )
    canvas.paste((int(low[0]), int(low[1])), placed[..., :3], placed[..., 3] / 255)


@lru_cache(maxsize=4096)
def _nearest(category: str, length_m: float, width_m: float) -> tuple[Design, ...]:
    """Designs of a category whose size differs least."""
    alike = [design for design in designs() if design.category == category]

    def distance(design: Design) -> float:
        return abs(design.size_m[0] - length_m) + abs(design.size_m[1] - width_m)

    return tuple(sorted(alike, key=distance)[:_CHOICES])


@lru_cache(maxsize=2048)
def _picture(design_id: str, category: str, colourway: str) -> ByteArray:
    """(h, w, 4) a design from above: lighter where it is higher and level."""
    design = next(d for d in designs() if d.id == design_id and d.category == category)
    width, height = (max(4, round(side * _PX_PER_M)) for side in design.size_m[:2])
    picture: ByteArray = np.zeros((height, width, 4), np.uint8)
    triangles, colors = _triangles(design, colourway)
    scale = np.array([_PX_PER_M, -_PX_PER_M])
    pixels = triangles[:, :, :2] * scale + (width / 2 - 0.5, height / 2 - 0.5)
    fixed = np.rint(pixels * (1 << _FINE_BITS)).astype(np.int32)
    # Lower ones first, so that what is highest remains.
    for index in triangles[:, :, 2].max(axis=1).argsort(kind="stable"):
        red, green, blue = colors[index].tolist()
        cv2.fillConvexPoly(picture, fixed[index], (red, green, blue, 255), shift=_FINE_BITS)
    return picture


def _triangles(design: Design, colourway: str) -> tuple[FloatArray, ByteArray]:
    """(T, 3, 3) corners of all that looks up, and (T, 3) colours."""
    corners, colors = [], []
    for part in design.parts():
        triangles = part.solid.points_m[part.solid.faces]
        normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        level = normals[:, 2] / np.maximum(np.linalg.norm(normals, axis=1), 1e-12)
        slot = design.colourways[colourway].get(part.slot, part.slot)
        finish = design.finishes.get(slot)
        rgb = np.array(finish.rgb if finish is not None else (170, 170, 170), np.float64)
        up = level > 0.05
        high = triangles[up][:, :, 2].mean(axis=1) / max(design.size_m[2], 0.1)
        # Light falls from the upper left.
        slope = (normals[up, 1] - normals[up, 0]) / np.maximum(
            np.linalg.norm(normals[up], axis=1), 1e-12
        )
        light = 0.62 + 0.25 * level[up] + 0.13 * np.clip(high, 0, 1) + 0.12 * slope
        corners.append(triangles[up])
        colors.append(np.clip(rgb * light[:, None], 0, 255).astype(np.uint8))
    return np.concatenate(corners), np.concatenate(colors)
