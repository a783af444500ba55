"""What a robot has to know of a house, as JSON: rooms, what opens and by which handle, supports,
things to grasp, poses to start from, tasks; `robot_layer.schema.json` is its schema.

Metres and radians in the frame of the stage. Ids of leaves, supports and things are prim paths.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from pxr import Usd, UsdGeom, UsdPhysics

from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import FloatArray, Item
from chord_usd.library.grasps import LIFTED_KG
from chord_usd.library.grasps import OPEN_M as GRIPPER_M
from chord_usd.library.prop import GRASPS
from chord_usd.line.stage.check.check_scene import solids_of
from chord_usd.line.stage.edit.leaves_and_lamps import LeafThere, free_shares, things_there
from chord_usd.line.stage.export.exchange.built_house import House
from chord_usd.line.stage.export.exchange.robot_map import Survey, stair_entries, surveyed
from chord_usd.line.stage.read.leaf_states import STATE

FORMAT = "chord-usd robot layer 1"
SCHEMA = Path(__file__).with_suffix(".schema.json")

_HANDLE = re.compile("handle(?!less)|rail|knob|grip", re.IGNORECASE)
_LEAST_TOP_M2, _LEVEL_M = 0.04, 0.004
_MOST_MOVES = 20


def write_robot_layer(stage: Usd.Stage, path: Path) -> None:
    """Write the layer of a house. Raises StageError."""
    storeys = surveyed(stage)
    free = free_shares(stage)
    there = [entry for entry in things_there(stage) if isinstance(entry, LeafThere)]
    transforms = UsdGeom.XformCache()
    openables = [_openable(stage, entry, free.get(entry.path, 1.0), transforms) for entry in there]
    supports = [record for entry in storeys for record in _supports(entry.house)]
    things = [record for entry in storeys for record in _graspable(stage, entry.house)]
    rooms = [record for entry in storeys for record in entry.rooms["rooms"]]
    layer = {
        "format": FORMAT,
        "stage": Path(stage.GetRootLayer().realPath).name,
        "units": "metres, radians, kilograms",
        "entrance": storeys[0].rooms["entrance"],
        "storeys": [
            {
                "name": entry.house.storey_title,
                "elevation": round(entry.house.elevation_m, 4),
                "rooms": [room.id for room in entry.house.plan.rooms],
            }
            for entry in storeys
        ],
        "stairs": stair_entries([entry.house for entry in storeys]),
        "rooms": rooms,
        "doors": [_door(record, openables) for entry in storeys for record in entry.rooms["doors"]],
        "openables": openables,
        "supports": supports,
        "graspable": things,
        "spawns": {room: poses for entry in storeys for room, poses in entry.ways_out.items()},
        "tasks": list(_tasks(storeys, openables, supports, things)),
    }
    path.write_text(json.dumps(layer, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def _door(record: Mapping[str, Any], openables: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """A door with the ids of its leaves."""
    room, _, name = record["id"].rpartition("_Door_")
    prefix = f"/{room}/Architecture/Geometry/Door_{name}/"
    return {**record, "leaves": [entry["id"] for entry in openables if prefix in entry["id"]]}


# What opens ---------------------------------------------------------------------------------------


def _openable(
    stage: Usd.Stage, leaf: LeafThere, free_share: float, transforms: UsdGeom.XformCache
) -> dict[str, Any]:
    prim = stage.GetPrimAtPath(leaf.path)
    parent = np.array(transforms.GetLocalToWorldTransform(prim.GetParent())).T
    axis = parent[:3, leaf.axis] / np.linalg.norm(parent[:3, leaf.axis])
    origin = parent[:3, :3] @ leaf.shut_m + parent[:3, 3]
    stretch = 1.0 if leaf.turns else float(np.linalg.norm(parent[:3, leaf.axis]))
    wide = math.radians(leaf.opens) if leaf.turns else leaf.opens * stretch
    state = prim.GetAttribute(STATE).Get() if prim.HasAttribute(STATE) else None
    return {
        "id": str(leaf.path),
        "piece": str(leaf.piece) if leaf.piece else None,
        "class": leaf.category,
        "rooms": list(leaf.rooms),
        "joint": {
            "type": "revolute" if leaf.turns else "prismatic",
            "origin": _rounded(origin),
            "axis": _rounded(axis),
            "open": round(wide, 4),
        },
        "free": round(free_share, 3),
        "state": state,
        "handles": [
            _handle(points, origin, axis, wide, turns=leaf.turns)
            for points in _grips(prim, transforms, leaf)
        ],
    }


def _grips(prim: Usd.Prim, transforms: UsdGeom.XformCache, leaf: LeafThere) -> list[FloatArray]:
    """(N, 3) points of each handle of a leaf; of the edge that moves most, where it has none."""
    solids = solids_of(prim, transforms)
    named = [entry for entry in solids if _HANDLE.search(entry.path.rsplit("/", 1)[-1])]
    if named:
        points = np.concatenate([entry.mesh.vertices for entry in named])
        if leaf.piece is not None:
            return [points]
        matrix = np.array(transforms.GetLocalToWorldTransform(prim)).T
        side = (points - matrix[:3, 3]) @ matrix[:3, 1]
        return [half for half in (points[side > 0.0], points[side < 0.0]) if len(half)]
    points = np.concatenate([entry.mesh.vertices for entry in solids])
    frame = np.array(transforms.GetLocalToWorldTransform(prim.GetParent())).T
    axis = frame[:3, leaf.axis] / np.linalg.norm(frame[:3, leaf.axis])
    away = points - frame[:3, 3] - frame[:3, :3] @ leaf.shut_m
    reach = np.linalg.norm(np.cross(away, axis), axis=1) if leaf.turns else away @ axis
    return [points[reach > reach.max() - 0.01]]


def _handle(
    points: FloatArray, origin: FloatArray, axis: FloatArray, wide: float, *, turns: bool
) -> dict[str, Any]:
    """Where a handle is, which way it goes first, and along which axis it lies."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = (low + high) / 2
    pull = np.cross(axis, middle - origin) if turns else axis
    pull = pull / max(float(np.linalg.norm(pull)), 1e-9) * math.copysign(1.0, wide)
    longest = np.eye(3)[int(np.argmax(high - low))]
    return {
        "position": _rounded(middle), "pull": _rounded(pull), "along": _rounded(longest),
        "size": _rounded(high - low),
    }  # fmt: skip


# What carries, and what is carried ----------------------------------------------------------------


def _supports(house: House) -> Iterator[dict[str, Any]]:
    """Tops on which things may stand."""
    for item in house.graph.items:
        body = house.bodies.get(item.id)
        if body is None or item.category not in having("supports"):
            continue
        corners = body.triangles_m
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        doubled = np.linalg.norm(normals, axis=1)
        flat = normals[:, 2] > 0.999 * np.maximum(doubled, 1e-12)
        heights = corners[flat][:, :, 2].mean(axis=1)
        level = _top(heights, doubled[flat] / 2)
        if level is None:
            continue
        on_top = corners[flat][np.abs(heights - level) < _LEVEL_M][:, :, :2]
        area = shapely.union_all(shapely.polygons(on_top), grid_size=1e-3)
        outline = area.convex_hull.simplify(0.005)
        yield {
            "id": item.id, "class": item.category, "room": item.room_id,
            "height": round(level + house.elevation_m, 4), "area": round(area.area, 4),
            "outline": np.round(np.asarray(outline.exterior.coords)[:-1], 4).tolist(),
            "carries": [child.id for child in item.children],
        }  # fmt: skip


def _top(heights_m: FloatArray, areas_m2: FloatArray) -> float | None:
    """The highest level that is wide enough to stand something on."""
    for height in np.unique(heights_m.round(3))[::-1]:
        if areas_m2[np.abs(heights_m - height) < _LEVEL_M].sum() >= _LEAST_TOP_M2:
            return float(height)
    return None


def _graspable(stage: Usd.Stage, house: House) -> Iterator[dict[str, Any]]:
    """Bodies that a parallel gripper lifts."""
    transforms = UsdGeom.XformCache()
    tied = {
        str(target)
        for prim in stage.Traverse() if prim.IsA(UsdPhysics.FixedJoint)
        for target in UsdPhysics.Joint(prim).GetBody1Rel().GetTargets()
    }  # fmt: skip
    for item, room_id, carrier in _carried(house):
        prim = stage.GetPrimAtPath(item.id)
        if not prim.HasAPI(UsdPhysics.RigidBodyAPI) or item.id in tied:
            continue
        mass_kg = float(UsdPhysics.MassAPI(prim).GetMassAttr().Get() or 0.0)
        if mass_kg > LIFTED_KG or min(item.box.size_m) > GRIPPER_M:
            continue
        x, y, z = item.box.center_m
        yield {
            "id": item.id, "class": item.category, "room": room_id, "on": carrier,
            "position": _rounded((x, y, z + house.elevation_m)),
            "yaw": round(math.radians(item.box.yaw_deg), 4),
            "size": _rounded(item.box.size_m), "mass": round(mass_kg, 4),
            "grasps": list(graspable_at(prim, transforms)),
        }  # fmt: skip


def graspable_at(prim: Usd.Prim, transforms: UsdGeom.XformCache) -> Iterator[dict[str, Any]]:
    """Those that were tried with its asset, where it stands; none where none were."""
    folders = dict.fromkeys(Path(spec.layer.realPath).parent for spec in prim.GetPrimStack())
    file = next((folder / GRASPS for folder in folders if (folder / GRASPS).is_file()), None)
    matrix = np.array(transforms.GetLocalToWorldTransform(prim)).T
    for grasp in json.loads(file.read_text(encoding="utf-8"))["grasps"] if file else ():
        closes, approach = (matrix[:3, :3] @ grasp[name] for name in ("closes", "approach"))
        stretch = float(np.linalg.norm(closes))
        width = grasp["width"] * stretch
        if width < GRIPPER_M:
            yield {
                "position": _rounded(matrix[:3, :3] @ grasp["position"] + matrix[:3, 3]),
                "closes": _rounded(closes / stretch),
                "approach": _rounded(approach / np.linalg.norm(approach)),
                "width": round(width, 4), "from_support": grasp["from_support"],
            }  # fmt: skip


def _carried(house: House) -> Iterator[tuple[Item, str, str | None]]:
    """Things, the id of the room of each, and of what it stands on."""
    for item in house.graph.items:
        for child in item.children:
            yield child, item.room_id, item.id
    for thing in house.graph.dressing:
        yield thing, thing.room_id, thing.facts.rests_on


# Tasks --------------------------------------------------------------------------------------------


def _tasks(
    storeys: Sequence[Survey], openables: Sequence[Mapping[str, Any]],
    supports: Sequence[Mapping[str, Any]], things: Sequence[Mapping[str, Any]],
) -> Iterator[dict[str, Any]]:  # fmt: skip
    """Tasks that can be done: to go, to open, to move a thing to another support of its room, or
    of the house."""
    for entry in storeys:
        for room in entry.rooms["rooms"]:
            if room["reachable"]:
                yield {"task": "go", "room": room["id"]}
    for leaf in openables:
        if leaf["free"] >= 0.9 and leaf["handles"]:
            yield {
                "task": "open",
                "openable": leaf["id"],
                "to": round(leaf["joint"]["open"] * 0.9, 4),
            }
    for thing in things[:_MOST_MOVES]:
        others = [entry for entry in supports if entry["id"] != thing["on"]]
        near = [entry for entry in others if entry["room"] == thing["room"]] or others
        if near:
            yield {"task": "move", "thing": thing["id"], "to": near[0]["id"]}


def _rounded(values: Sequence[float] | FloatArray) -> list[float]:
    return [round(float(value), 4) for value in values]
