"""Reads the house back from its stage: rooms, openings, items, and their meshes in the world.

What is read is what is there: floors and footprints come from meshes and transforms, not from
notes the author left. Only what no mesh can say is taken from attributes: categories, kinds of
rooms, and which prim is an item. Prim paths serve as ids.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from pxr import Gf, Sdf, Usd, UsdGeom
from shapely.geometry import Polygon

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.stages import ELEVATION, storey_prims
from chord_usd.base.scene.geometry import Floors, polygons_of, rooms_beside
from chord_usd.base.scene.types import (
    ROOM_KINDS,
    Box,
    Facts,
    FloatArray,
    Item,
    Opening,
    OpeningKind,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.stage.author.furniture import DRESSING, FURNITURE
from chord_usd.line.stage.author.names import BORDER
from chord_usd.line.stage.author.stage_levels import SHAFT, STAIR_WALK
from chord_usd.line.stage.check.check_contact import Body, Solid
from chord_usd.line.stage.check.check_rules import NODE_ID
from chord_usd.line.stage.check.triangles import Triangles
from chord_usd.line.stage.shell.mesh import fans

CATEGORY = "chord:category"
SIZE = "chord:size_m"
"""Attributes of the prims of items and openings."""

POLYGON = "chord:polygon_m"
"""Attribute of the prims of rooms: (N, 2) as they were planned."""

OOD_NOTE = "chord:ood"
"""Attribute of the prims of items that the layout model was asked about."""

RESTS_ON = "chord:rests_on"
"""Attribute of the prims of dressing: node id of what carries it."""

_KINDS: dict[str, OpeningKind] = {"door": "door", "window": "window", "passage": "passage"}
KnownMeshes = dict[Sdf.Path, Triangles]

_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
_SNAP_M = 1e-4
_LEAST_HOLE_M = 0.01


@dataclass(frozen=True, eq=False)
class StageScene:
    """A house as it stands on its stage."""

    graph: SceneGraph
    """Ids are prim paths; items have no assets."""
    items: tuple[Body, ...]
    """One per item, tabletop items and dressing included; path is the item's id."""
    fixed: tuple[Body, ...]
    """Walls, frames of openings and what hangs in them."""
    ground: tuple[Body, ...]
    """Floors, thresholds and window boards."""
    elevation_m: float = 0.0
    """Of its floor: everything else is in the storey's own frame."""
    ceilings: tuple[Body, ...] = ()
    stairs: tuple[StageStair, ...] = ()
    """Up from this storey."""
    by_stairs: frozenset[str] = frozenset()
    """Ids of openings that are where one steps onto stairs or off."""
    shafts: tuple[Room, ...] = ()
    """What stairs take up, as it was noted: a hole has no mesh."""
    holes: tuple[Polygon, ...] = ()
    """What of these has no floor."""

    @property
    def entered_graph(self) -> SceneGraph:
        """The graph without openings by which one steps onto stairs: they are no entrances."""
        kept = (each for each in self.graph.openings if each.id not in self.by_stairs)
        return replace(self.graph, openings=tuple(kept))


@dataclass(frozen=True, eq=False)
class StageStair:
    """A stair as it stands on its stage."""

    body: Body
    walk_m: FloatArray
    """(N, 3) the line that one walks up, in the frame of the storey that it starts on."""


def read_scene(stage: Usd.Stage) -> StageScene:
    """The rooms below `<default prim>/Rooms` and what is in them. Payloads must be loaded.

    Raises StageError for a house of several storeys, which is no scene on one floor.
    """
    storeys = read_storeys(stage)
    if len(storeys) > 1:
        raise StageError(
            f"the house has {len(storeys)} storeys, and this is not made for these yet",
            where=stage.GetRootLayer().identifier,
            expected="a house of one storey",
        )
    return storeys[0]


def read_storeys(stage: Usd.Stage) -> list[StageScene]:
    """The storeys of a house, the lowest first; a house without storeys is one."""
    storeys = storey_prims(stage)
    if not storeys:
        return [_read_storey(_children(stage.GetDefaultPrim(), "Rooms"), 0.0)]
    return [
        _read_storey(list(prim.GetFilteredChildren(_PROXIES)), prim.GetAttribute(ELEVATION).Get())
        for prim in storeys
    ]


def _read_storey(rooms: Sequence[Usd.Prim], elevation_m: float) -> StageScene:
    reader = _Reader(elevation_m)
    for prim in rooms:
        reader.read_room(prim)
    reader.link_carriers()
    floors = Floors(reader.rooms)
    return StageScene(
        elevation_m=elevation_m,
        ceilings=_meshed(reader.ceilings),
        stairs=tuple(reader.stairs),
        by_stairs=frozenset(reader.by_stairs),
        shafts=tuple(reader.shafts),
        holes=tuple(reader.holes),
        graph=SceneGraph(
            tuple(reader.rooms),
            tuple(
                replace(opening, room_ids=rooms_beside(opening.box, floors))
                for opening in reader.openings
            ),
            tuple(reader.items),
            dressing=tuple(reader.dressing),
        ),
        items=tuple(reader.bodies),
        fixed=_meshed(reader.fixed),
        ground=_meshed(reader.ground),
    )


def _meshed(bodies: Sequence[Body]) -> tuple[Body, ...]:
    """Those that are there: a balcony all of whose sides are walls has parts without a mesh."""
    return tuple(body for body in bodies if body.solids)


class _Reader:
    """Collects a house room by room."""

    def __init__(self, elevation_m: float) -> None:
        self.elevation_m = elevation_m
        self.ceilings: list[Body] = []
        self.stairs: list[StageStair] = []
        self.by_stairs: list[str] = []
        self.shafts: list[Room] = []
        self.holes: list[Polygon] = []
        self.rooms: list[Room] = []
        self.openings: list[Opening] = []
        self.items: list[Item] = []
        self.dressing: list[Item] = []
        self.bodies: list[Body] = []
        self.fixed: list[Body] = []
        self.ground: list[Body] = []
        self._transforms = UsdGeom.XformCache()
        self._meshes: KnownMeshes = {}
        self._paths: dict[str, str] = {}
        """Of items, by node id."""

    def link_carriers(self) -> None:
        """Let dressing name what it rests on by its path, once all is read."""
        carriers = {
            item.id: self._paths.get(item.facts.rests_on or "", "") for item in self.dressing
        }
        self.dressing = [
            item.with_facts(rests_on=carriers[item.id] or None) for item in self.dressing
        ]
        self.bodies = [
            replace(body, parent=carriers[body.path]) if carriers.get(body.path) else body
            for body in self.bodies
        ]

    def read_room(self, prim: Usd.Prim) -> None:
        path, shaft = str(prim.GetPath()), _text(prim, CATEGORY) == SHAFT
        floors = []
        for part in _children(prim.GetChild("Architecture"), "Geometry"):
            name = part.GetName()
            if name == "Floor" or name.startswith("Floor_"):
                floors.append(self._body(part))
            elif name.startswith("Wall"):
                self.fixed.append(self._body(part))
            elif name.startswith(BORDER):
                continue  # rooms that touch say as much
            elif _text(part, CATEGORY) in _KINDS:
                self._read_opening(part)
                self.by_stairs += [self.openings[-1].id] if shaft else []
            elif name.startswith("Ceiling"):
                self.ceilings.append(self._body(part))
            elif shaft:
                self.fixed.append(self._body(part))
                self._read_stair(part)
        self.ground += floors
        polygon = _outline(floors)
        if polygon is not None and not shaft:
            self.rooms.append(Room(path, room_kind_of(prim), polygon, name=prim.GetName()))
        elif shaft and prim.HasAttribute(POLYGON):
            noted = frozen_array(np.array(prim.GetAttribute(POLYGON).Get(), dtype=np.float64))
            self.shafts.append(Room(path, room_kind_of(prim), noted, name=prim.GetName()))
            self.holes += _holes(noted, floors)
        for group, things in ((FURNITURE, self.items), (DRESSING, self.dressing)):
            for part in _children(prim, group):
                item = self._read_item(part, path, carrier=None)
                if item is not None:
                    things.append(item)

    def _read_opening(self, prim: Usd.Prim) -> None:
        kind = _KINDS[_text(prim, CATEGORY)]
        size = prim.GetAttribute(SIZE).Get()
        matrix = self._matrix(prim)
        self.openings.append(
            Opening(
                id=str(prim.GetPath()),
                kind=kind,
                box=Box(_place_m(matrix), (size[0], size[1], size[2]), _yaw_deg(matrix)),
            )
        )
        body = self._body(prim)
        self.ground.append(body)
        self.fixed.append(body)

    def _read_item(self, prim: Usd.Prim, room: str, carrier: Body | None) -> Item | None:
        """An item and, where its prim is a group, what stands on it. None for other prims."""
        piece = prim
        carried: list[Usd.Prim] = []
        if not prim.HasAttribute(NODE_ID):
            pieces = [child for child in prim.GetChildren() if child.HasAttribute(NODE_ID)]
            if not pieces:
                return None
            piece, carried = pieces[0], _children(prim, "Items")
        body = self._body(piece, parent=carrier.path if carrier else "")
        if not body.solids:
            return None
        self.bodies.append(body)
        self._paths[_text(piece, NODE_ID)] = body.path
        children = (self._read_item(child, room, body) for child in carried)
        # Overlap is compared among what stands on one table, so the world's frame serves as well.
        return Item(
            id=body.path,
            category=_text(piece, CATEGORY),
            box=_own_box(body, self._matrix(piece), piece.GetAttribute(SIZE).Get()),
            room_id=room,
            children=tuple(child for child in children if child is not None),
            facts=_facts(piece),
        )

    def _read_stair(self, prim: Usd.Prim) -> None:
        walk = prim.GetAttribute(STAIR_WALK).Get() if prim.HasAttribute(STAIR_WALK) else None
        if walk:
            self.stairs.append(StageStair(self.fixed[-1], np.array(walk, dtype=np.float64)))

    def _matrix(self, prim: Usd.Prim) -> FloatArray:
        return _to_world(prim, self._transforms, self.elevation_m)

    def _body(self, prim: Usd.Prim, parent: str = "") -> Body:
        solids = solids_of(prim, self._transforms, self._meshes, self.elevation_m)
        return Body(str(prim.GetPath()), solids, parent)


def solids_of(
    prim: Usd.Prim,
    transforms: UsdGeom.XformCache,
    known: KnownMeshes | None = None,
    elevation_m: float = 0.0,
) -> tuple[Solid, ...]:
    """What is seen at and below a prim, in the world.

    known: meshes that were read before, by their paths in prototypes; filled. elevation_m: height
    in the world from which heights count.
    """
    known = {} if known is None else known
    solids = []
    for mesh in _shown_meshes(prim):
        path = mesh.GetPrimInPrototype().GetPath() if mesh.IsInstanceProxy() else mesh.GetPath()
        if path not in known:
            known[path] = _triangles(mesh)
        matrix = _to_world(mesh, transforms, elevation_m)
        solids.append(
            Solid(str(mesh.GetPath()), known[path].placed(matrix[:3, :3].T, matrix[:3, 3]))
        )
    return tuple(solids)


def _to_world(
    prim: Usd.Prim, transforms: UsdGeom.XformCache, elevation_m: float = 0.0
) -> FloatArray:
    """(4, 4) local to world, column vectors; less the elevation of its storey."""
    matrix = np.array(transforms.GetLocalToWorldTransform(prim)).T
    matrix[2, 3] -= elevation_m
    return matrix


def _children(prim: Usd.Prim, name: str) -> list[Usd.Prim]:
    child = prim.GetChild(name) if prim else None
    return list(child.GetFilteredChildren(_PROXIES)) if child else []


def _text(prim: Usd.Prim, name: str) -> str:
    value = prim.GetAttribute(name).Get() if prim.HasAttribute(name) else None
    return value if isinstance(value, str) else ""


def _facts(prim: Usd.Prim) -> Facts:
    noted = prim.GetAttribute(OOD_NOTE).Get() if prim.HasAttribute(OOD_NOTE) else None
    return Facts(
        ood=noted if isinstance(noted, float) else None, rests_on=_text(prim, RESTS_ON) or None
    )


def room_kind_of(prim: Usd.Prim) -> RoomKind:
    """From the room's semantic label."""
    labels = prim.GetAttribute("semantics:labels:room").Get() or ()
    return next((kind for kind in ROOM_KINDS if kind in labels), "unknown")


def _shown_meshes(prim: Usd.Prim) -> Iterator[Usd.Prim]:
    """Meshes at or below a prim that are rendered; those inside instances too."""
    for below in Usd.PrimRange(prim, _PROXIES):
        if below.IsA(UsdGeom.Mesh):
            shape = UsdGeom.Imageable(below)
            is_guide = shape.ComputePurpose() == UsdGeom.Tokens.guide
            if not is_guide and shape.ComputeVisibility() != UsdGeom.Tokens.invisible:
                yield below


def _triangles(prim: Usd.Prim) -> Triangles:
    """A mesh prim in its own frame, its faces cut into triangles."""
    mesh = UsdGeom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(), dtype=np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=np.int64)
    return Triangles(points, corners[fans(counts)])


def _holes(shaft: FloatArray, floors: list[Body]) -> list[Polygon]:
    """What of a shaft no floor covers."""
    pieces = [shapely.polygons(body.triangles_m[:, :, :2]) for body in floors if body.solids]
    floor = shapely.union_all(np.concatenate(pieces)) if pieces else Polygon()
    free = Polygon(shaft).difference(floor.buffer(_LEAST_HOLE_M, join_style="mitre"))
    return [part for part in polygons_of(free) if part.area > _LEAST_HOLE_M]


def _outline(floors: list[Body]) -> FloatArray | None:
    """(N, 2) outline of a floor's triangles seen from above; None where there is no floor."""
    triangles = [body.triangles_m[:, :, :2] for body in floors if body.solids]
    if not triangles:
        return None
    pieces = shapely.polygons(np.concatenate(triangles))
    floor = shapely.union_all(shapely.set_precision(pieces[shapely.area(pieces) > 0], _SNAP_M))
    parts = polygons_of(floor)
    if not parts:
        return None
    outline = shapely.geometry.polygon.orient(max(parts, key=lambda part: part.area))
    return frozen_array(np.array(outline.exterior.simplify(_SNAP_M).coords)[:-1])


def _place_m(matrix: FloatArray) -> tuple[float, float, float]:
    return float(matrix[0, 3]), float(matrix[1, 3]), float(matrix[2, 3])


def _yaw_deg(matrix: FloatArray) -> float:
    return wrap_deg(math.degrees(math.atan2(matrix[1, 0], matrix[0, 0])))


def _own_box(body: Body, matrix: FloatArray, catalogued: Gf.Vec3d | None) -> Box:
    """The bounds of the meshes in the item's own frame, as a box in the world.

    catalogued: the item's size where it is noted. Only its height is used: a tap that rises over
    its cabinet does not make the cabinet block a window.
    """
    turn = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    local_m = body.vertices_m @ turn
    low, high = local_m.min(axis=0), local_m.max(axis=0)
    middle = turn @ np.array([*(low[:2] + high[:2]) / 2, low[2]])
    size_m = np.maximum(high - low, _SNAP_M)
    height_m = float(size_m[2]) if catalogued is None else min(float(size_m[2]), catalogued[2])
    return Box(
        center_m=(float(middle[0]), float(middle[1]), float(middle[2])),
        size_m=(float(size_m[0]), float(size_m[1]), height_m),
        yaw_deg=_yaw_deg(matrix),
    )
