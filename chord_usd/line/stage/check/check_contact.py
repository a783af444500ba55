"""Meshes against meshes: what runs into what, and what stands on nothing (SceneEval's rules)."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import fcl
import numpy as np
import shapely

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.check.triangles import Triangles, cross

MIN_DEPTH_M = 0.005
"""Contact no deeper than this is touching."""

SUPPORT_GAP_M = 0.01
"""Surfaces this far below a foot, or above it, still carry it."""

HULL_SLACK_M = 0.005
"""A centroid this far outside the hull of its supports does not tip over yet."""

_EDGE_M = 5e-4
"""A foot flush with a wall stands on the edge of the floor; meshes hold their corners rounded."""

_TOUCH_M = 1e-5
"""What is this near may touch."""

_MAX_CONTACTS = 64
_GRID_M = 0.01
"""Of many feet in one cell of this size one is enough."""

_RIM_STEP_M, _MOST_RIM_STEPS = 0.01, 64


@dataclass(frozen=True, eq=False)
class Solid:
    """One mesh, placed in the world."""

    path: str
    mesh: Triangles
    """In world coordinates, metres. A wall is an open sheet, furniture is closed."""

    @cached_property
    def triangles_m(self) -> FloatArray:
        """(M, 3, 3)."""
        corners: FloatArray = np.asarray(self.mesh.vertices)[np.asarray(self.mesh.faces)]
        return corners

    @cached_property
    def bounds_m(self) -> FloatArray:
        """(2, 3) lowest and highest corner."""
        corners = self.mesh.corners
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @cached_property
    def triangle_bounds_m(self) -> tuple[FloatArray, FloatArray]:
        """(M, 3) lowest and highest corner of each triangle."""
        a, b, c = (self.triangles_m[:, k] for k in range(3))
        return np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)

    @cached_property
    def area_m2(self) -> float:
        """Of the surface, one side of it."""
        a, b, c = (self.triangles_m[:, k] for k in range(3))
        return float(np.sqrt((cross(b - a, c - a) ** 2).sum(axis=1)).sum() / 2)

    def mass(self) -> tuple[float, FloatArray]:
        """Volume in m³ of a closed mesh, and the (3,) centre of it in metres."""
        low_m = self.bounds_m[0]
        local_m = self.triangles_m - low_m
        a, b, c = (local_m[:, k] for k in range(3))
        volumes = np.einsum("ij,ij->i", a, cross(b, c)) / 6
        volume = float(volumes.sum())
        if not volume:
            return 0.0, self.bounds_m.mean(axis=0)
        return abs(volume), low_m + volumes @ (a + b + c) / (4 * volume)

    @property
    def is_convex(self) -> bool:
        """A sheet is flat and yet not convex: its holes are holes."""
        return self.mesh.is_convex

    @cached_property
    def collider(self) -> Any:
        """The fcl object."""
        vertices, faces = self.mesh.vertices, self.mesh.faces
        if self.is_convex:
            counted = np.insert(faces, 0, 3, axis=1)
            return fcl.CollisionObject(fcl.Convex(vertices, len(faces), counted.flatten()))
        tree = fcl.BVHModel()
        tree.beginModel(num_tris_=len(faces), num_vertices_=len(vertices))
        tree.addSubModel(verts=vertices, triangles=faces)
        tree.endModel()
        return fcl.CollisionObject(tree)

    def placed(self, linear: FloatArray, offset_m: FloatArray) -> Solid:
        """Each vertex v, as a row, at v @ linear (3, 3) + offset_m (3,)."""
        return Solid(self.path, self.mesh.placed(linear, offset_m))


@dataclass(frozen=True, eq=False)
class Body:
    """What moves as one: an item without its children, or a wall."""

    path: str
    solids: tuple[Solid, ...]
    parent: str = ""
    """Path of the body that carries it, where it is a tabletop item or dressing."""

    @cached_property
    def bounds_m(self) -> FloatArray:
        """(2, 3) lowest and highest corner of all solids."""
        corners = np.array([solid.bounds_m for solid in self.solids])
        return np.array([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])

    @cached_property
    def vertices_m(self) -> FloatArray:
        """(N, 3)."""
        return np.concatenate([solid.mesh.vertices for solid in self.solids])

    @cached_property
    def triangles_m(self) -> FloatArray:
        """(M, 3, 3)."""
        return np.concatenate([solid.triangles_m for solid in self.solids])

    @cached_property
    def levels_m(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(M,) lowest and highest point of each triangle, and twice its area seen from above,
        negative where it faces down."""
        a, b, c = (self.triangles_m[:, k] for k in range(3))
        ab, ac = b - a, c - a
        return (
            np.minimum(np.minimum(a[:, 2], b[:, 2]), c[:, 2]),
            np.maximum(np.maximum(a[:, 2], b[:, 2]), c[:, 2]),
            ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0],
        )

    @cached_property
    def centroid_m(self) -> FloatArray:
        """(3,) centre of mass of an even material; of the bounds, where nothing is closed."""
        closed = [solid.mass() for solid in self.solids if solid.mesh.is_watertight]
        volumes = np.array([volume for volume, _ in closed])
        if not closed or volumes.sum() <= 0:
            center: FloatArray = self.bounds_m.mean(axis=0)
            return center
        return np.average([center for _, center in closed], axis=0, weights=volumes)


@dataclass(frozen=True)
class Collision:
    """Two bodies that share space."""

    a: str
    b: str
    depth_m: float


def collisions(
    items: Sequence[Body],
    walls: Sequence[Body],
    underfoot: Collection[str] = (),
    soft: Collection[str] = (),
) -> list[Collision]:
    """Items that run into each other or into a wall by more than MIN_DEPTH_M.

    underfoot: paths of items that others stand on, compared with walls only. soft: paths of items
    that sink into what carries them, which is not compared with them.
    """
    pairs = []
    items_at = {item.path for item in items}
    for a, b in _near_pairs(items, walls):
        if (a.path == b.parent and b.path in soft) or (b.path == a.parent and a.path in soft):
            continue
        if b.path in items_at and (a.path in underfoot or b.path in underfoot):
            continue
        depth_m = _depth_m(a, b)
        if depth_m > MIN_DEPTH_M:
            pairs.append(Collision(a.path, b.path, round(depth_m, 4)))
    return pairs


def _near_pairs(items: Sequence[Body], walls: Sequence[Body]) -> Iterator[tuple[Body, Body]]:
    """Item and item, then item and wall, where the bounds meet."""
    bodies = [*items, *walls]
    if not items:
        return
    bounds = np.array([body.bounds_m for body in bodies])
    for index, item in enumerate(items):
        meets = _meets(bounds[index], bounds[index + 1 :])
        for other in np.flatnonzero(meets):
            yield item, bodies[index + 1 + int(other)]


def _meets(box: FloatArray, others: FloatArray) -> Any:
    """(N,) whether the box (2, 3) meets each of the boxes (N, 2, 3)."""
    return ((box[0] <= others[:, 1]) & (others[:, 0] <= box[1])).all(axis=1)


def _depth_m(a: Body, b: Body) -> float:
    """Deepest contact of two bodies; 0.0 where they are apart."""
    others = np.array([solid.bounds_m for solid in b.solids])
    depths = [
        _solid_depth_m(solid, b.solids[int(index)])
        for solid in a.solids
        for index in np.flatnonzero(_meets(solid.bounds_m, others))
    ]
    return max(depths, default=0.0)


def _solid_depth_m(a: Solid, b: Solid) -> float:
    """Contact depth of two meshes: how far one has to move to come free of the other."""
    if _apart(a, b):
        return 0.0
    contacts = _contacts(a.collider, b.collider)
    depth_m = max((float(contact.penetration_depth) for contact in contacts), default=0.0)
    if depth_m <= MIN_DEPTH_M or (a.is_convex and b.is_convex):
        return depth_m
    # Between triangles fcl measures how far each reaches through the other's plane, which is too
    # much where a rounded edge just touches. So see whether a small step sets the meshes free.
    normals = np.array([contact.normal for contact in contacts])
    steps = np.unique(np.round(np.concatenate([np.eye(3), normals]), 2), axis=0)
    for step in (*steps, *-steps):
        a.collider.setTranslation(step * MIN_DEPTH_M)
        is_free = not _touches(a.collider, b.collider)
        a.collider.setTranslation(np.zeros(3))
        if is_free:
            return MIN_DEPTH_M
    return depth_m


def _apart(a: Solid, b: Solid) -> bool:
    """Whether no triangle of one reaches into the bounds of the other.

    To build a tree of a mesh takes far longer. What is convex is solid: it may hold the other.
    """
    low = np.maximum(a.bounds_m[0], b.bounds_m[0]) - _TOUCH_M
    high = np.minimum(a.bounds_m[1], b.bounds_m[1]) + _TOUCH_M
    for solid in (a, b):
        lowest, highest = solid.triangle_bounds_m
        if not ((lowest <= high) & (highest >= low)).all(axis=1).any() and not solid.is_convex:
            return True
    return False


def _contacts(a: Any, b: Any) -> Any:
    request = fcl.CollisionRequest(num_max_contacts=_MAX_CONTACTS, enable_contact=True)
    result = fcl.CollisionResult()
    fcl.collide(a, b, request, result)
    return result.contacts


def _touches(a: Any, b: Any) -> bool:
    return bool(fcl.collide(a, b, fcl.CollisionRequest(), fcl.CollisionResult()))


# --- support ------------------------------------------------------------------------------------


def unsupported(
    items: Sequence[Body], ground: Sequence[Body], is_held: Callable[[Body], bool]
) -> list[str]:
    """Paths of items with nothing within SUPPORT_GAP_M below, or that would tip over.

    ground: floors and whatever else of the building one may stand on. is_held: whether something
    other than what is below carries an item (a panel on its wall).
    """
    carriers = [*ground, *items]
    if not carriers:
        return []
    bounds = np.array([body.bounds_m for body in carriers])
    paths = []
    for item in items:
        reach = item.bounds_m + np.array([[-SUPPORT_GAP_M], [SUPPORT_GAP_M]])
        below = [carriers[int(k)] for k in np.flatnonzero(_meets(reach, bounds))]
        if not _stands(item, [body for body in below if body is not item]) and not is_held(item):
            paths.append(item.path)
    return paths


def _stands(item: Body, carriers: Sequence[Body]) -> bool:
    """Whether the centroid lies over the hull of the points at which the item is carried.

    More points only widen the hull, so that those which take longer to find come last.
    """
    low_m = float(item.bounds_m[0, 2])
    tops = [_level(carrier, low_m, facing=1.0) for carrier in carriers]
    points: list[FloatArray] = []
    for find in (_feet_on, _corners_under, _rims_under):
        points += find(item, carriers, tops, low_m)
        if _balances(item, points):
            return True
    return False


def _feet_on(
    item: Body, carriers: Sequence[Body], tops: Sequence[FloatArray], low_m: float
) -> list[FloatArray]:
    """(N, 3) points of an item's underside that touch a carrier, for each carrier."""
    feet = _thinned(item.vertices_m[item.vertices_m[:, 2] < low_m + SUPPORT_GAP_M])
    return [feet[_touch(feet, top)] for top in tops]


def _corners_under(
    item: Body, carriers: Sequence[Body], tops: Sequence[FloatArray], low_m: float
) -> list[FloatArray]:
    """(N, 3) corners of each carrier, which may be the smaller, under the item's sole."""
    soles = _level(item, low_m, facing=-1.0)
    points = []
    for carrier in carriers:
        corners = carrier.vertices_m
        corners = corners[np.abs(corners[:, 2] - low_m) < 2 * SUPPORT_GAP_M]
        corners = _thinned(corners[_over(corners, item.bounds_m)])
        points.append(corners[_touch(corners, soles)])
    return points


def _rims_under(
    item: Body, carriers: Sequence[Body], tops: Sequence[FloatArray], low_m: float
) -> list[FloatArray]:
    """(N, 3) points along the sides of each carrier's triangles under the item's sole.

    A pot on the bars of a grate: they cross below its sole, and no corner lies there.
    """
    soles = _level(item, low_m, facing=-1.0)
    rims = [_thinned(_rims(top, item.bounds_m)) for top in tops]
    return [points[_touch(points, soles)] for points in rims]


def _balances(item: Body, contacts: Sequence[FloatArray]) -> bool:
    """Whether an item's centroid lies over the hull of (N, 3) points."""
    contact = np.concatenate(contacts) if contacts else np.zeros((0, 3))
    if not len(contact):
        return False
    hull = shapely.convex_hull(shapely.multipoints(contact[:, :2])).buffer(HULL_SLACK_M)
    return bool(hull.contains(shapely.Point(item.centroid_m[:2])))


def _rims(triangles: FloatArray, bounds_m: FloatArray) -> FloatArray:
    """(N, 3) points along the sides of triangles (M, 3, 3), those within the bounds from above."""
    starts, ends = triangles.reshape(-1, 3), np.roll(triangles, -1, axis=1).reshape(-1, 3)
    if not len(starts):
        return starts
    longest = float(np.linalg.norm(ends - starts, axis=1).max())
    share = np.linspace(0.0, 1.0, min(2 + int(longest / _RIM_STEP_M), _MOST_RIM_STEPS))
    meets = (np.minimum(starts, ends) <= bounds_m[1]) & (np.maximum(starts, ends) >= bounds_m[0])
    due = meets[:, 0] & meets[:, 1]
    starts, ends = starts[due], ends[due]
    points = (starts[:, None] + share[:, None] * (ends - starts)[:, None]).reshape(-1, 3)
    return points[_over(points, bounds_m)]


def _over(points: FloatArray, bounds_m: FloatArray) -> Any:
    """(N,) whether points lie within the bounds, seen from above."""
    (low_x, low_y, _), (high_x, high_y, _) = bounds_m
    x, y = points[:, 0], points[:, 1]
    return (x >= low_x) & (x <= high_x) & (y >= low_y) & (y <= high_y)


def _level(body: Body, height_m: float, facing: float) -> FloatArray:
    """(M, 3, 3) a body's triangles near this height that face up (1.0) or down (-1.0)."""
    low, high, upwards = body.levels_m
    near = (low < height_m + 2 * SUPPORT_GAP_M) & (high > height_m - 2 * SUPPORT_GAP_M)
    return body.triangles_m[near & (facing * upwards > 1e-9)]


def _thinned(points: FloatArray) -> FloatArray:
    """One point of each cell of _GRID_M, the outermost kept: (N, 3) to (K, 3)."""
    if len(points) < 200:
        return points
    _, first = np.unique(np.round(points[:, :2] / _GRID_M), axis=0, return_index=True)
    return points[first]


def _touch(points: FloatArray, triangles: FloatArray) -> Any:
    """(N,) whether each point has one of the triangles within SUPPORT_GAP_M below or above.

    Beside a triangle by no more than _EDGE_M is over it.
    """
    if not len(points) or not len(triangles):
        return np.zeros(len(points), dtype=bool)
    triangles = triangles[_within_reach(points, triangles)]
    a, b, c = (triangles[:, k] for k in range(3))
    ab, ac = (b - a)[:, :2], (c - a)[:, :2]
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    offset = points[:, None, :2] - a[None, :, :2]
    v = (offset[..., 0] * ac[:, 1] - offset[..., 1] * ac[:, 0]) / area
    w = (ab[:, 0] * offset[..., 1] - ab[:, 1] * offset[..., 0]) / area
    # Each share falls from 1 to 0 over the triangle's height above the opposite side.
    slack = [_EDGE_M * np.hypot(*side.T) / np.abs(area) for side in (ac, ab, ac - ab)]
    inside = (v >= -slack[0]) & (w >= -slack[1]) & (v + w <= 1 + slack[2])
    v, w = np.clip(v, 0.0, 1.0), np.clip(w, 0.0, 1.0)
    height = a[:, 2] + v * (b - a)[:, 2] + w * (c - a)[:, 2]
    near = np.abs(height - points[:, None, 2]) <= SUPPORT_GAP_M
    return (inside & near).any(axis=1)


def _within_reach(points: FloatArray, triangles: FloatArray) -> Any:
    """(M,) whether a triangle, grown by _EDGE_M on each side, can be over or under any point.

    Of a floor with hundreds of triangles one or two are below a foot.
    """
    plane = triangles[:, :, :2]
    a, b, c = (plane[:, k] for k in range(3))
    opposite = [np.hypot(*side.T)[:, None] for side in (c - b, a - c, b - a)]
    around = opposite[0] + opposite[1] + opposite[2]
    middle = (opposite[0] * a + opposite[1] * b + opposite[2] * c) / around
    ab, ac = b - a, c - a
    doubled = np.abs(ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0])[:, None]
    # Each side moves out by _EDGE_M: the triangle grows from the centre of its incircle.
    grown = 1.0 + (_EDGE_M + 1e-6) * around / doubled
    corners = middle[:, None] + grown[:, None] * (plane - middle[:, None])
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    meets = (corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)
    return meets[:, 0] & meets[:, 1]
