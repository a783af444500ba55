"""What is measured on meshes of assets and kept: heights from above, open boards, leaves."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
from pxr import Sdf
from safetensors import SafetensorError
from safetensors.numpy import load, save

from chord_usd.base.errors import ChordError
from chord_usd.base.places.swept import Boxes, Leaf
from chord_usd.base.raster.relief import LEAST_HEIGHT, Relief
from chord_usd.base.runtime.asset_stages import open_asset
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.locations import cache_folder
from chord_usd.base.runtime.stages import layer_beside
from chord_usd.base.scene.articulation import (
    JOINTED_LAYER,
    JOINTS,
    PAYLOAD_LAYER,
    layer_file,
    layer_places,
)
from chord_usd.base.scene.types import Asset, FloatArray, Item

if TYPE_CHECKING:
    from pxr import Usd

CELL_M = 0.005

_FINE_BITS = 4

_UPPER_SIDE = np.array([[(-1, -1, 1), (1, -1, 1), (1, 1, 1)], [(-1, -1, 1), (1, 1, 1), (-1, 1, 1)]])
"""(2, 3, 3) triangles of a cube's upper side, from -1 to 1."""


def relief_of(asset: Asset) -> Relief:
    """The relief of an asset at its own size, read from its meshes once.

    Parts that rise above its nominal height are in it. Raises AssetError for a file that cannot be
    opened.
    """
    return _read(asset.usd_path, asset.size_m)


@lru_cache(maxsize=256)
def _read(path: Path, size_m: tuple[float, float, float]) -> Relief:
    def measure() -> Arrays:
        seen, colliders = triangles_m(path)
        arrays = {"seen": _from_above(seen, size_m)}
        return {**arrays, "felt": _from_above(colliders, size_m)} if len(colliders) else arrays

    arrays = kept(path, "reliefs", Path(__file__), measure)
    return Relief(arrays["seen"], size_m, arrays.get("felt"))


def _from_above(triangles_m: FloatArray, size_m: tuple[float, float, float]) -> FloatArray:
    """(rows, columns) highest point of triangles (N, 3, 3) in every cell of a footprint."""
    normals_z = np.cross(
        triangles_m[:, 1, :2] - triangles_m[:, 0, :2], triangles_m[:, 2, :2] - triangles_m[:, 0, :2]
    )
    tops_m = triangles_m[:, :, 2].max(axis=1)
    kept = np.abs(normals_z) > 1e-10
    kept &= tops_m > LEAST_HEIGHT * size_m[2]
    rows, columns = (max(round(side / CELL_M), 1) for side in (size_m[1], size_m[0]))
    scale = np.array([columns / size_m[0], -rows / size_m[1]])
    points = triangles_m[kept][:, :, :2] * scale + (columns / 2 - 0.5, rows / 2 - 0.5)
    points = np.rint(points * (1 << _FINE_BITS)).astype(np.int32)
    heights = np.zeros((rows, columns), np.float32)
    # Lower ones first, so that what is highest remains.
    for index in tops_m[kept].argsort(kind="stable"):
        height = float(tops_m[kept][index])
        cv2.fillConvexPoly(heights, points[index], (height,), shift=_FINE_BITS)
    return heights.astype(np.float64)


def triangles_m(path: Path) -> tuple[FloatArray, FloatArray]:
    """(N, 3, 3) corners of all triangles that are shown, and of all that collide.

    Both in the frame of the asset. Of a cube that collides, its upper side.
    """
    from pxr import UsdGeom, UsdPhysics

    stage = open_asset(path)
    transforms = UsdGeom.XformCache()
    seen, colliders = [np.zeros((0, 3, 3))], [np.zeros((0, 3, 3))]
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Gprim):
            continue
        matrix = np.array(transforms.GetLocalToWorldTransform(prim))
        collides = prim.HasAPI(UsdPhysics.CollisionAPI)
        if prim.IsA(UsdGeom.Mesh):
            faces_m = _faces_m(prim, matrix)
            if UsdGeom.Imageable(prim).ComputePurpose() != "guide":
                seen.append(faces_m)
            if collides:
                colliders.append(faces_m)
        elif prim.IsA(UsdGeom.Cube) and collides:
            half = UsdGeom.Cube(prim).GetSizeAttr().Get() / 2
            colliders.append(_UPPER_SIDE * half @ matrix[:3, :3] + matrix[3, :3])
    return np.concatenate(seen), np.concatenate(colliders)


def _faces_m(prim: Usd.Prim, matrix: FloatArray) -> FloatArray:
    """(N, 3, 3) triangles of one mesh; faces are cut into fans."""
    from pxr import UsdGeom

    mesh = UsdGeom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=np.int64)
    points = points @ matrix[:3, :3] + matrix[3, :3]
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)
    faces = np.repeat(np.arange(len(counts)), np.maximum(counts - 2, 0))
    step = np.arange(len(faces)) - np.searchsorted(faces, faces) + 1
    first = starts[faces]
    return points[np.stack([corners[first], corners[first + step], corners[first + step + 1]], 1)]


# What is measured on shipped assets, kept beside them: they never change -------------------------

Arrays = dict[str, FloatArray]


def kept(asset_path: Path, name: str, source: Path, measure: Callable[[], Arrays]) -> Arrays:
    """The result of measure for an asset, from the cache where it is there.

    name: of the measurement. source: the module that measures; its change repeats the measurement.
    Only results for assets in the cache are kept, to seven digits; a failure to write is ignored.
    """
    folder = asset_path.parent.parent
    if folder.parent != cache_folder():
        return measure()
    place = folder.with_name(f"{folder.name}-{name}-{_hash(source)}")
    file = place / f"{asset_path.stem}.safetensors"
    arrays = _load(file)
    if arrays is None:
        _keep(file, measure())
        arrays = _load(file)
    return measure() if arrays is None else arrays


@lru_cache(maxsize=8)
def _hash(source: Path) -> str:
    return hashlib.sha256(source.read_bytes()).hexdigest()[:8]


def _load(file: Path) -> Arrays | None:
    """None where there is none, or not a whole one."""
    try:
        arrays = load(file.read_bytes())
    except (OSError, SafetensorError):
        return None
    return {name: array.astype(np.float64) for name, array in arrays.items()}


def _keep(file: Path, arrays: Arrays) -> None:
    packed = save({name: np.ascontiguousarray(a, dtype=np.float32) for name, a in arrays.items()})
    with contextlib.suppress(OSError, ChordError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(file, packed)


# Open boards of an asset, seen from its front: where books and bowls can stand in it -------------

BOARD_CELL_M = 0.01

_LEAST_M = (0.14, 0.14, 0.12)
"""Smallest length, depth and clear height of a compartment that is worth filling."""

_FULL = 0.9
"""Share of its bounds that a compartment fills."""

_DEEP = 0.5
"""Share of the asset's depth that is clear: before what stands in a shelf already is no place."""

_OFF_FLOOR_M = 0.03
"""What is lower is the floor between the legs of a piece."""

_OPEN_ABOVE_M = 0.25
_TOP_SHARE = 0.75
"""Share of the footprint that a top covers."""


def boards_of(asset: Asset) -> FloatArray:
    """(N, 6) open boards in the asset's own frame: lowest x, front y, z of the board; highest x,
    back y, z up to which it is clear.

    Compartments without a door, and of what hangs on walls its top. Raises AssetError for a file
    that cannot be opened.
    """
    return _boards(asset.usd_path, asset)


@lru_cache(maxsize=256)
def _boards(path: Path, asset: Asset) -> FloatArray:
    def find() -> dict[str, FloatArray]:
        seen_m, _ = triangles_m(path)
        inside = _compartments(_from_front(seen_m, asset.size_m), asset.size_m)
        levelled = [
            board for compartment in inside if (board := _on_level(compartment, seen_m)) is not None
        ]
        boards = [*levelled, *_top(asset)]
        return {"boards": np.array(boards, np.float64).reshape(-1, 6)}

    return kept(path, "boards", Path(__file__), find)["boards"]


def _from_front(triangles: FloatArray, size_m: tuple[float, float, float]) -> FloatArray:
    """(rows, columns) depth behind the front at which one sees something, rows from the floor up.

    Where nothing is seen, the depth of the asset.
    """
    columns, rows = (max(round(side / BOARD_CELL_M), 1) for side in (size_m[0], size_m[2]))
    flat = triangles[:, :, [0, 2]]
    across = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    shown = triangles[np.abs(across) > 1e-9]
    near = shown[:, :, 1].min(axis=1) + size_m[1] / 2
    scale = np.array([columns / size_m[0], rows / size_m[2]])
    points = shown[:, :, [0, 2]] * scale + (columns / 2 - 0.5, -0.5)
    points = np.rint(points * (1 << _FINE_BITS)).astype(np.int32)
    depth = np.full((rows, columns), size_m[1], np.float32)
    for index in (-near).argsort(kind="stable"):
        value = float(max(near[index], 0.0))
        cv2.fillConvexPoly(depth, points[index], (value,), shift=_FINE_BITS)
    return depth.astype(np.float64)


def _compartments(depth: FloatArray, size_m: tuple[float, float, float]) -> list[list[float]]:
    """Right-angled openings deep enough to stand something in."""
    is_open = (depth > _LEAST_M[1]).astype(np.uint8)
    count, _, stats, _ = cv2.connectedComponentsWithStats(is_open, connectivity=4)
    cell_x, cell_z = size_m[0] / depth.shape[1], size_m[2] / depth.shape[0]
    compartments = []
    for column, row, wide, high, cells in stats[1:count]:
        low, top = row * cell_z, (row + high) * cell_z
        is_small = wide * cell_x < _LEAST_M[0] or high * cell_z < _LEAST_M[2]
        if is_small or cells < _FULL * wide * high or low < _OFF_FLOOR_M:
            continue
        inside = depth[row : row + high, column : column + wide]
        deep = float(np.quantile(inside, 0.05))
        if deep < _DEEP * size_m[1]:
            continue
        if row + high >= depth.shape[0]:
            top += _OPEN_ABOVE_M
        left = column * cell_x - size_m[0] / 2
        front = -size_m[1] / 2
        compartments.append([left, front, low, left + wide * cell_x, front + deep, top])
    return compartments


def _on_level(board: list[float], triangles: FloatArray) -> list[float] | None:
    """The compartment from the very height of its board and from that board's front edge, which
    may lie behind doors and handles below; None where there is no board or it is too narrow.
    """
    flat = triangles[np.ptp(triangles[:, :, 2], axis=1) < 1e-4]
    level, x = flat[:, 0, 2], flat[:, :, 0]
    middle = (board[0] + board[3]) / 2
    below = (x.min(axis=1) < middle) & (x.max(axis=1) > middle)
    below &= np.abs(level - board[2]) < 1.5 * BOARD_CELL_M
    if not below.any():
        return None
    height = float(level[below].max())
    front = float(flat[below & (level > height - 1e-4)][:, :, 1].min())
    is_deep = board[4] - front >= _LEAST_M[1]
    return [board[0], front, height, *board[3:]] if is_deep else None


def _top(asset: Asset) -> list[list[float]]:
    """The top of a shelf."""
    length, depth, height = asset.size_m
    if asset.category != "wall_shelf":
        return []
    covered = relief_of(asset).heights_m >= height - 0.004
    if float(covered.mean()) < _TOP_SHARE:
        return []
    return [[-length / 2, -depth / 2, height, length / 2, depth / 2, height + 0.45]]


# The leaves of an asset, and the boxes of its colliders: read from its layers, not -- -------------

_JOINTS = ("PhysicsRevoluteJoint", "PhysicsPrismaticJoint")


@dataclass(frozen=True, eq=False)
class Openable:
    """An asset in its frame, at its size."""

    leaves: tuple[Leaf, ...]
    colliders_m: FloatArray
    """(N, 2, 3) boxes of its colliders while all is shut."""


@lru_cache(maxsize=512)
def openable(interface: str) -> Openable | None:
    """What opens of an asset, by the identifier of its interface layer; None for assets of other
    makers, whose layers are not known."""
    payload, jointed = (
        layer_beside(interface, *layer_places(name)) for name in (PAYLOAD_LAYER, JOINTED_LAYER)
    )
    if payload is None:
        return None
    colliders = [bounds for root in payload.rootPrims for bounds in _collider_bounds(payload, root)]
    leaves = () if jointed is None else tuple(
        leaf for root in jointed.rootPrims for leaf in _leaves(jointed, root)
    )  # fmt: skip
    return Openable(leaves, np.array(colliders).reshape(-1, 2, 3))


def leaves_of(item: Item) -> list[Leaf]:
    """What opens of a piece, at its size; nothing without a mesh."""
    asset = item.asset
    if asset is None or layer_file(asset.usd_path, JOINTED_LAYER) is None:
        return []
    known = openable(str(asset.usd_path))
    if known is None:
        return []
    factor = np.array(item.box.size_m) / np.array(asset.size_m)
    return [leaf.scaled(factor) for leaf in known.leaves]


def collider_boxes(item: Item) -> Boxes:
    """Boxes of a piece's colliders, in the world; its box without a mesh of this library."""
    asset = item.asset
    if asset is None or layer_file(asset.usd_path, PAYLOAD_LAYER) is None:
        return Boxes.filling(item.box)
    known = openable(str(asset.usd_path))
    if known is None:
        return Boxes.filling(item.box)
    factor = np.array(item.box.size_m) / np.array(asset.size_m)
    return Boxes.of(known.colliders_m * factor).placed(item.box)


def _leaves(layer: Sdf.Layer, root: Sdf.PrimSpec) -> Iterator[Leaf]:
    joints = layer.GetPrimAtPath(root.path.AppendChild(JOINTS))
    for joint in joints.nameChildren if joints else ():
        if joint.typeName not in _JOINTS:
            continue
        body = layer.GetPrimAtPath(root.path.AppendChild(joint.name))
        at = np.array(_value(joint, "physics:localPos0"), dtype=float)
        limits = _value(joint, "physics:lowerLimit"), _value(joint, "physics:upperLimit")
        boxes = np.array(list(_collider_bounds(layer, body))).reshape(-1, 2, 3) + at
        if len(boxes):
            yield Leaf(
                joint.name, joint.typeName == _JOINTS[0],
                "XYZ".index(_value(joint, "physics:axis")), at, float(max(limits, key=abs)), boxes,
            )  # fmt: skip


def _collider_bounds(layer: Sdf.Layer, root: Sdf.PrimSpec) -> Iterator[FloatArray]:
    """(2, 3) bounds of each collider below a prim, which is at the origin."""
    colliders = layer.GetPrimAtPath(root.path.AppendChild("Colliders"))
    for cube in colliders.nameChildren if colliders else ():
        half = np.array(_value(cube, "xformOp:scale")) * _value(cube, "size") / 2
        at = np.array(_value(cube, "xformOp:translate"), dtype=float)
        yield np.array([at - half, at + half])
    geometry = layer.GetPrimAtPath(root.path.AppendChild("Geometry"))
    for mesh in geometry.nameChildren if geometry else ():
        if "PhysicsCollisionAPI" in mesh.GetInfo("apiSchemas").GetAppliedItems():
            extent = _value(mesh, "extent")
            if extent is None:
                shape = layer.GetPrimAtPath(f"/Shapes/{mesh.name}")
                extent = _value(shape, "extent") if shape else None
            if extent is not None:
                yield np.array(extent, dtype=float)


def _value(prim: Sdf.PrimSpec, name: str) -> Any:
    attribute = prim.attributes.get(name)
    return attribute.default if attribute else None
