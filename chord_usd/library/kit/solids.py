"""Watertight solids: blocks, cushions, lofts, extrusions, tubes. The clay of all furniture.

Every function returns a closed triangle mesh whose faces look outwards. Unless said otherwise a
solid stands with the centre of its underside at the origin; lengths are metres.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Literal

import mapbox_earcut
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import FloatArray, frozen_array

IntArray = npt.NDArray[np.int64]
Axis = Literal["x", "y", "z"]
Size = tuple[float, float, float]

WELD_M = 1e-6
"""Points closer than this are one point."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed triangle mesh, or several of them side by side."""

    points_m: FloatArray
    """(N, 3) vertices."""
    faces: IntArray
    """(T, 3) indices into points_m, counter-clockwise seen from outside."""

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Solid:
        """Shifted by metres."""
        return Solid(frozen_array(self.points_m + np.array([x, y, z])), self.faces)

    def turned(self, axis: Axis, angle_deg: float) -> Solid:
        """Turned about a coordinate axis through the origin, counter-clockwise looking down it."""
        first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        cos, sin = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
        matrix = np.eye(3)
        matrix[first, first] = matrix[second, second] = cos
        matrix[first, second], matrix[second, first] = -sin, sin
        return Solid(frozen_array(self.points_m @ matrix.T), self.faces)

    def scaled(self, x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Solid:
        """Stretched about the origin; a mirror image where one factor is negative."""
        faces = self.faces if x * y * z > 0.0 else self.faces[:, ::-1]
        points = frozen_array(self.points_m * np.array([x, y, z]))
        return Solid(points, frozen_array(faces, np.int64))

    def bounds_m(self) -> FloatArray:
        """(2, 3) lowest and highest corner."""
        return np.array([self.points_m.min(axis=0), self.points_m.max(axis=0)])

    def __add__(self, other: Solid) -> Solid:
        """Both, side by side; not a boolean union."""
        return Solid(
            frozen_array(np.concatenate([self.points_m, other.points_m])),
            frozen_array(np.concatenate([self.faces, other.faces + len(self.points_m)]), np.int64),
        )


def joined(solids: Sequence[Solid]) -> Solid:
    """All of them in one mesh; at least one must be given."""
    return reduce(lambda left, right: left + right, solids)


def mirrored_pair(solid: Solid) -> Solid:
    """The solid and its mirror image across x = 0."""
    return solid + solid.scaled(x=-1.0)


def pair(solid: Solid, *, x: float = 0.0, y: float = 0.0) -> list[Solid]:
    """The solid twice: moved by (-x, -y) and by (x, y) metres."""
    return [solid.moved(-x, -y), solid.moved(x, y)]


def at_corners(solid: Solid, x: float, y: float) -> list[Solid]:
    """The solid four times, moved by x and y metres to either side; the left ones first."""
    return [solid.moved(sx * x, sy * y) for sx in (-1, 1) for sy in (-1, 1)]


def ring_of(solid: Solid, count: int) -> list[Solid]:
    """The solid count times, turned about the z axis in even steps."""
    return [solid.turned("z", 360.0 * index / count) for index in range(count)]


def welded(points_m: npt.ArrayLike, faces: npt.ArrayLike) -> Solid:
    """A solid whose coinciding points are merged and whose collapsed triangles are gone."""
    points = np.asarray(points_m, dtype=np.float64)
    corners = np.asarray(faces, dtype=np.int64)
    keys = np.round(points / WELD_M).astype(np.int64)
    _, first, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    corners = rank[inverse.reshape(-1)][corners]
    whole = (
        (corners[:, 0] != corners[:, 1])
        & (corners[:, 1] != corners[:, 2])
        & (corners[:, 2] != corners[:, 0])
    )
    return Solid(frozen_array(points[first[order]]), frozen_array(corners[whole], np.int64))


def ring(
    length_m: float, width_m: float, radius_m: float, z_m: float = 0.0, steps: int = 4
) -> FloatArray:
    """(4 * (steps + 1), 3) points of a rounded rectangle around the origin, counter-clockwise.

    radius_m is clipped to what fits, so a large one gives a stadium or a circle.
    """
    half_length, half_width = length_m / 2, width_m / 2
    radius = max(min(radius_m, half_length, half_width), 0.0)
    points = []
    for quarter, (sign_x, sign_y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        angles = np.radians(90.0 * quarter + np.linspace(0.0, 90.0, steps + 1))
        x = sign_x * (half_length - radius) + radius * np.cos(angles)
        y = sign_y * (half_width - radius) + radius * np.sin(angles)
        points.append(np.stack([x, y, np.full_like(x, z_m)], axis=-1))
    return np.concatenate(points)


def circle(radius_m: float, z_m: float = 0.0, sides: int = 24) -> FloatArray:
    """(sides, 3) points, counter-clockwise; radius 0 gives a pole."""
    angles = np.linspace(0.0, 2 * math.pi, sides, endpoint=False)
    x, y = radius_m * np.cos(angles), radius_m * np.sin(angles)
    return np.stack([x, y, np.full_like(x, z_m)], axis=-1)


def loft(rings: Sequence[FloatArray], *, loop: bool = False) -> Solid:
    """Skin over rings of equally many points, counter-clockwise seen from the last one's side.

    Both ends are closed with a fan around their centre, so they must be star-shaped; with loop
    the last ring joins the first instead, as in a hoop. A ring may collapse to a pole. Rings may
    turn inwards again (a tub): the skin simply follows them.
    """
    sides, levels = len(rings[0]), len(rings)
    here = np.arange(sides)
    after = (here + 1) % sides
    faces = []
    for level in range(levels if loop else levels - 1):
        low, high = level * sides, (level + 1) % levels * sides
        faces.append(np.stack([low + here, low + after, high + after], axis=-1))
        faces.append(np.stack([low + here, high + after, high + here], axis=-1))
    points = np.concatenate(rings)
    if loop:
        return welded(points, np.concatenate(faces))
    top, ends = (levels - 1) * sides, levels * sides
    faces.append(np.stack([after, here, np.full(sides, ends)], axis=-1))
    faces.append(np.stack([top + here, top + after, np.full(sides, ends + 1)], axis=-1))
    centres = [rings[0].mean(axis=0), rings[-1].mean(axis=0)]
    return welded(np.concatenate([points, centres]), np.concatenate(faces))


def lathe(
    profile_m: Sequence[tuple[float, float]], sides: int = 24, *, loop: bool = False
) -> Solid:
    """Turned on a lathe: (radius, z) pairs from the underside, over the outside, to the top.

    With loop the profile is closed, as of a hoop or a lamp shade.
    """
    return loft([circle(radius, z, sides) for radius, z in profile_m], loop=loop)


def rounded_profile(
    profile_m: Sequence[tuple[float, float]], rounds: int = 2
) -> list[tuple[float, float]]:
    """A profile for lathe with its corners cut off, again and again (Chaikin); the ends stay."""
    points = np.array(profile_m, dtype=np.float64)
    for _ in range(rounds):
        before, after = points[:-1], points[1:]
        cut = np.stack([0.75 * before + 0.25 * after, 0.25 * before + 0.75 * after], axis=1)
        points = np.concatenate([points[:1], cut.reshape(-1, 2)[1:-1], points[-1:]])
    return [(float(radius), float(z)) for radius, z in points]


def cylinder(
    radius_m: float, height_m: float, bevel_m: float = 0.0, sides: int = 24, top_m: float = -1.0
) -> Solid:
    """A round post; top_m is the radius at the top where it tapers."""
    top = radius_m if top_m < 0.0 else top_m
    if bevel_m <= 0.0:
        return lathe([(radius_m, 0.0), (top, height_m)], sides)
    bevel = min(bevel_m, height_m / 3, radius_m / 2, top / 2)
    return lathe(
        [
            (radius_m - bevel, 0.0),
            (radius_m, bevel),
            (top, height_m - bevel),
            (top - bevel, height_m),
        ],
        sides,
    )


def box(size_m: Size) -> Solid:
    """A plain box, twelve triangles; for what is never seen from near."""
    length, width, height = size_m
    corners = ring(length, width, 0.0, 0.0, steps=0)
    points = np.concatenate([corners, corners + np.array([0.0, 0.0, height])])
    faces = [[0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]
    for i in range(4):
        j = (i + 1) % 4
        faces += [[i, j, j + 4], [i, j + 4, i + 4]]
    return welded(points, faces)


def block(size_m: Size, bevel_m: float = 0.003) -> Solid:
    """A box with chamfered edges, about 60 triangles: what a joiner makes."""
    length, width, height = size_m
    bevel = min(bevel_m, min(size_m) / 4)
    inner = ring(length - 2 * bevel, width - 2 * bevel, 0.4 * bevel, 0.0, steps=1)
    outer = ring(length, width, bevel, 0.0, steps=1)
    lift = np.array([0.0, 0.0, 1.0])
    return loft(
        [inner, outer + lift * bevel, outer + lift * (height - bevel), inner + lift * height]
    )


def rounded_slab(
    size_m: Size, corner_m: float, bevel_m: float = 0.004, steps: int = 6, rounds: int = 1
) -> Solid:
    """A plate with round corners in plan and bevelled rims: worktops, tubs, seats."""
    length, width, height = size_m
    bevel = min(bevel_m, height / 2, length / 4, width / 4)
    rings = []
    for angle in np.radians(np.linspace(0.0, 90.0, rounds + 1)):
        inset, rise = bevel * (1.0 - math.sin(angle)), bevel * (1.0 - math.cos(angle))
        corner = max(corner_m - inset, 0.0)
        rings.append(ring(length - 2 * inset, width - 2 * inset, corner, rise, steps))
    for flat in reversed(list(rings)):
        rings.append(flat * [1.0, 1.0, -1.0] + [0.0, 0.0, height])
    return loft(rings)


def cushion(
    size_m: Size, corner_m: float = 0.06, round_m: float = 0.05, crown_m: float = 0.03
) -> Solid:
    """An upholstered block: round corners and rims, top swollen by crown_m within the height."""
    length, width, height = size_m
    edge = height - crown_m
    rim = min(round_m, edge / 2, length / 4, width / 4)
    rings = []
    for angle in np.radians((0.0, 30.0, 60.0, 90.0)):
        inset, rise = rim * (1.0 - math.sin(angle)), rim * (1.0 - math.cos(angle))
        flat = ring(length - 2 * inset, width - 2 * inset, corner_m - inset, rise, 3)
        rings.append(_with_edge_points(flat, 4))
    rings += [flat * [1.0, 1.0, -1.0] + [0.0, 0.0, edge] for flat in reversed(list(rings))]
    last = rings[-1]
    half = np.abs(last[:, :2]).max(axis=0)
    for share in (0.75, 0.4, 0.0):
        inner = last * [share, share, 1.0]
        # A product of two parabolas has no ridge along the diagonals, as a pyramid would.
        inner[:, 2] += crown_m * np.prod(1.0 - (inner[:, :2] / half) ** 2, axis=1)
        rings.append(inner)
    return loft(rings)


def _with_edge_points(outline: FloatArray, corner_points: int) -> FloatArray:
    """A ring of ring() with two more points on each straight side."""
    sides = outline.reshape(4, corner_points, 3)
    following = np.roll(sides, -1, axis=0)[:, 0]
    extra = [sides[:, -1] + (following - sides[:, -1]) * share for share in (1 / 3, 2 / 3)]
    return np.concatenate([sides, np.stack(extra, axis=1)], axis=1).reshape(-1, 3)


def bevelled_plate(outline_m: npt.ArrayLike, thick_m: float, bevel_m: float) -> Solid:
    """A plate over a star-shaped outline (N, 2), counter-clockwise, with chamfered rims."""
    outline = np.asarray(outline_m, dtype=np.float64)
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    inner = middle + (outline - middle) * (1.0 - 2 * bevel_m / np.ptp(outline, axis=0))
    levels = ((inner, 0.0), (outline, bevel_m), (outline, thick_m - bevel_m), (inner, thick_m))
    return loft([np.column_stack([flat, np.full(len(flat), z)]) for flat, z in levels])


def pillow(size_m: Size, steps: int = 4) -> Solid:
    """A stuffed pillow: thin pointed rim, full middle, sides drawn in."""
    length, width, height = size_m
    rim = ring(length, width, 0.18 * min(length, width), 0.0, steps)
    # Sides draw in between the corners, as they do on anything stuffed.
    drawn = 1.0 - 0.05 * np.cos(np.pi * np.clip(2 * np.abs(rim) / [length, width, 1.0], 0, 1))
    rim = rim * np.stack([drawn[:, 1], drawn[:, 0], np.ones(len(rim))], axis=-1)
    rim *= [length / np.ptp(rim[:, 0]), width / np.ptp(rim[:, 1]), 1.0]
    shares = np.array([0.0, 0.35, 0.63, 0.83, 0.95])
    swell = height / 2 * np.sqrt(1.0 - shares**2.2) * (1.0 - 0.12 * shares)
    below = [rim * [s, s, 0] + [0, 0, height / 2 - z] for s, z in zip(shares, swell, strict=True)]
    above = [rim * [s, s, 0] + [0, 0, height / 2 + z] for s, z in zip(shares, swell, strict=True)]
    return loft([*below, rim + np.array([0.0, 0.0, height / 2]), *reversed(above)])


def soft_block(size_m: Size, radius_m: float, cells: tuple[int, int, int]) -> Solid:
    """A rounded box with a grid on every face, ready to be creased; cells along x, y, z."""
    half = np.array(size_m) / 2
    radius = min(radius_m, *(half * 0.98))
    lines = [_rounded_lines(float(h), radius, n) for h, n in zip(half, cells, strict=True)]
    points, faces, count = [], [], 0
    for axis in range(3):
        u_lines, v_lines = lines[(axis + 1) % 3], lines[(axis + 2) % 3]
        for side in (-1.0, 1.0):
            grid = np.empty((len(u_lines), len(v_lines), 3))
            grid[..., axis] = side * half[axis]
            grid[..., (axis + 1) % 3] = u_lines[:, None]
            grid[..., (axis + 2) % 3] = v_lines[None, :]
            points.append(grid.reshape(-1, 3))
            faces.append(count + _grid_faces(len(u_lines), len(v_lines), flip=side < 0.0))
            count += grid.shape[0] * grid.shape[1]
    cube = np.concatenate(points)
    core = np.clip(cube, -(half - radius), half - radius)
    outward = cube - core
    outward /= np.maximum(np.linalg.norm(outward, axis=-1, keepdims=True), 1e-9)
    return welded(core + radius * outward + [0.0, 0.0, half[2]], np.concatenate(faces))


def _rounded_lines(half_m: float, radius_m: float, cells: int) -> FloatArray:
    """Grid lines along one edge: one step inside each rounded end, `cells` between."""
    middle = np.linspace(-(half_m - radius_m), half_m - radius_m, cells + 1)
    step = radius_m * math.tan(math.radians(22.5))
    ends = [-half_m, -half_m + radius_m - step]
    return np.concatenate([ends, middle, [-end for end in reversed(ends)]])


def _grid_faces(rows: int, columns: int, *, flip: bool) -> IntArray:
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = (
        index[:-1, :-1].ravel(),
        index[1:, :-1].ravel(),
        index[1:, 1:].ravel(),
        index[:-1, 1:].ravel(),
    )
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return faces[:, ::-1] if flip else faces


def creased(solid: Solid, depth_m: float, wave_m: float) -> Solid:
    """Cloth folds: points pushed out and in by smooth waves, at most depth_m either way."""
    phase = 2 * math.pi * solid.points_m / wave_m
    x, y, z = phase[:, 0], phase[:, 1], phase[:, 2]
    push = (
        np.sin(0.83 * x + 0.47 * y + 1.3)
        + 0.7 * np.sin(-0.61 * x + 1.21 * y + 0.4)
        + 0.6 * np.sin(1.57 * x - 0.36 * y + 0.9 * z + 2.1)
    ) / 2.3
    centre = solid.bounds_m().mean(axis=0)
    outward = (solid.points_m - centre) / (np.ptp(solid.bounds_m(), axis=0) / 2)
    outward /= np.maximum(np.linalg.norm(outward, axis=-1, keepdims=True), 1e-9)
    points = solid.points_m + depth_m * push[:, None] * outward
    return Solid(frozen_array(points), solid.faces)


def extruded(
    outline_m: npt.ArrayLike, height_m: float, holes_m: Sequence[npt.ArrayLike] = ()
) -> Solid:
    """A plate of height_m over a simple outline (N, 2), counter-clockwise, with clockwise or
    counter-clockwise holes (M, 2) inside it."""
    outline = np.asarray(outline_m, dtype=np.float64)[:, :2]
    holes = [np.asarray(hole, dtype=np.float64)[:, :2] for hole in holes_m]
    holes = [hole if _area(hole) < 0.0 else hole[::-1] for hole in holes]
    loops = [outline, *holes]
    flat = np.concatenate(loops)
    ends = np.cumsum([len(loop) for loop in loops]).astype(np.uint32)
    cap = mapbox_earcut.triangulate_float64(flat, ends).reshape(-1, 3).astype(np.int64)
    corner = flat[cap]
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    clockwise = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] < 0.0
    cap[clockwise] = cap[clockwise][:, ::-1]
    count = len(flat)
    faces = [cap[:, ::-1], cap + count]
    start = 0
    for loop in loops:
        here = np.arange(len(loop))
        after = (here + 1) % len(loop)
        low, high = start + here, start + after
        faces.append(np.stack([low, high, high + count], -1))
        faces.append(np.stack([low, high + count, low + count], -1))
        start += len(loop)
    low_points = np.column_stack([flat, np.zeros(count)])
    return welded(
        np.concatenate([low_points, low_points + np.array([0.0, 0.0, height_m])]),
        np.concatenate(faces),
    )


def _area(loop: FloatArray) -> float:
    after = np.roll(loop, -1, axis=0)
    return float(np.sum(loop[:, 0] * after[:, 1] - loop[:, 1] * after[:, 0])) / 2


def tube(path_m: npt.ArrayLike, radius_m: float, sides: int = 10) -> Solid:
    """A round bar along an open path (N, 3) that never turns back on itself."""
    path = np.asarray(path_m, dtype=np.float64)
    steps = np.diff(path, axis=0)
    steps /= np.linalg.norm(steps, axis=1, keepdims=True)
    tangents = np.concatenate([steps[:1], steps[:-1] + steps[1:], steps[-1:]])
    stretch = np.linalg.norm(tangents[1:-1], axis=1) / 2
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    side = np.cross(tangents[0], np.eye(3)[np.argmin(np.abs(tangents[0]))])
    angles = np.linspace(0.0, 2 * math.pi, sides, endpoint=False)
    rings = []
    for index, (point, tangent) in enumerate(zip(path, tangents, strict=True)):
        side = side - tangent * (side @ tangent)
        side /= np.linalg.norm(side)
        up = np.cross(tangent, side)
        # A mitre is cut at a slant: without this the bar would thin at sharp bends.
        wide = 1.0 / stretch[index - 1] if 0 < index < len(path) - 1 else 1.0
        bend = _bend_direction(steps, index, tangent)
        offsets = radius_m * (np.cos(angles)[:, None] * side + np.sin(angles)[:, None] * up)
        offsets = offsets + (offsets @ bend)[:, None] * bend * (wide - 1.0)
        rings.append(point + offsets)
    return loft(rings)


def _bend_direction(steps: FloatArray, index: int, tangent: FloatArray) -> FloatArray:
    """Unit vector in the plane of the bend, across the tangent; zero at the ends."""
    if not 0 < index < len(steps):
        return np.zeros(3)
    across = steps[index] - steps[index - 1]
    across = across - tangent * (across @ tangent)
    size = np.linalg.norm(across)
    return across / size if size > 1e-9 else np.zeros(3)


def bent_path(corners_m: npt.ArrayLike, radius_m: float, steps: int = 4) -> FloatArray:
    """(M, 3) path through corners (N, 3) whose inner corners are rounded with radius_m."""
    corners = np.asarray(corners_m, dtype=np.float64)
    path = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:], strict=False):
        arms = before - corner, after - corner
        reach = min(radius_m, *(0.45 * float(np.linalg.norm(arm)) for arm in arms))
        start, end = (corner + reach * arm / np.linalg.norm(arm) for arm in arms)
        for share in np.linspace(0.0, 1.0, steps + 1):
            path.append(
                (1 - share) ** 2 * start + 2 * share * (1 - share) * corner + share**2 * end
            )
    return np.array([*path, corners[-1]])
