"""A stage as a scene data set of Habitat: a stage, objects, a scene with their places, regions.

Files follow habitat-sim's page "Using JSON Files to configure Attributes"; Habitat is Y up.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from pxr import Sdf, Usd, UsdGeom, UsdLux, UsdPhysics
from scipy.spatial.transform import Rotation

from chord_usd.base.errors import StageError
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import ROOM_HEIGHT_M, FloatArray
from chord_usd.line.stage.check.check_scene import read_storeys
from chord_usd.line.stage.export.exchange.mjcf_frames import Frames, rigid, scale_of
from chord_usd.line.stage.export.gltf import Y_UP, write_glb
from chord_usd.line.stage.export.gltf_lights import LUX_PER_UNIT, light_of

HOUSE = "house"
TEXTURE_PX = 512

_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
_SEMANTIC_IDS = {name: number for number, name in enumerate(CATEGORIES, start=1)}


def write_habitat(stage: Usd.Stage, folder: Path) -> None:
    """Write the data set for what the stage has selected into the folder, new or empty.

    What stands free is DYNAMIC, leaves of doors and windows KINEMATIC, everything else STATIC.
    Raises StageError for a stage with nothing in it.
    """
    things = [Thing(prim) for prim in things_of(stage)]
    frames = Frames(stage)
    for kind in ("stages", "objects", "scenes", "lighting", "semantics"):
        (folder / kind).mkdir()
    templates = _Templates(stage, folder / "objects", frames)
    scene = {
        "translation_origin": "asset_local",
        "stage_instance": {"template_name": f"stages/{HOUSE}"},
        "object_instances": [_instance(thing, templates, frames) for thing in things],
        "default_lighting": f"lighting/{HOUSE}",
        "semantic_scene_instance": HOUSE,
    }
    lights = {"lights": dict(_lights(stage, frames))}
    with _hidden(stage, [thing.prim for thing in things]):
        write_glb(stage, folder / "stages" / f"{HOUSE}.glb", TEXTURE_PX)
    shell = {"render_asset": f"{HOUSE}.glb", "collision_asset": f"{HOUSE}.glb"} | _UPRIGHT
    _write(folder / "stages" / f"{HOUSE}.stage_config.json", shell)
    _write(folder / "scenes" / f"{HOUSE}.scene_instance.json", scene)
    _write(folder / "lighting" / f"{HOUSE}.lighting_config.json", lights)
    _write(folder / "semantics" / f"{HOUSE}.semantic_config.json", _semantics(stage))
    _write(folder / f"{HOUSE}.scene_dataset_config.json", _DATA_SET)


_UPRIGHT = {"up": [0, 1, 0], "front": [0, 0, -1], "units_to_meters": 1.0}

_DATA_SET = {
    "stages": {"paths": {".json": ["stages"]}},
    "objects": {"paths": {".json": ["objects"]}},
    "light_setups": {"paths": {".json": ["lighting"]}},
    "scene_instances": {"paths": {".json": ["scenes"]}},
    "semantic_scene_descriptor_instances": {HOUSE: f"semantics/{HOUSE}.semantic_config.json"},
}


@dataclass(frozen=True, eq=False)
class Thing:
    """What is an object of its own: a component, or a body."""

    prim: Usd.Prim

    @property
    def category(self) -> str:
        """Its label, that of the door or window it is a leaf of; "" where it has none."""
        above = self.prim.GetParent()
        for prim, taxonomy in ((self.prim, "class"), (above, "category")):
            values = prim.GetAttribute(f"semantics:labels:{taxonomy}").Get()
            if values:
                return str(values[0])
        return ""

    @property
    def motion(self) -> str:
        """One of Habitat's types of motion."""
        if not self.prim.HasAPI(UsdPhysics.RigidBodyAPI):
            return "STATIC"
        return "DYNAMIC" if _is_component(self.prim) else "KINEMATIC"

    @property
    def model(self) -> str:
        """Things of one model look the same."""
        source = self.prim.GetPrototype() if self.prim.IsInstance() else self.prim
        return str(source.GetPath())

    @property
    def mass_kg(self) -> float:
        """0 for what says none."""
        api = UsdPhysics.MassAPI(self.prim)
        return float(api.GetMassAttr().Get() or 0.0) if api else 0.0

    @property
    def name(self) -> str:
        """Of its model, as people know it."""
        return str(Usd.ModelAPI(self.prim).GetAssetName() or self.prim.GetName())


def things_of(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """Instances of components and what moves alone, below the default prim."""
    below = iter(Usd.PrimRange(stage.GetDefaultPrim()))
    for prim in below:
        is_piece = prim.IsInstance() or prim.HasAttribute("chord:category")
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) or (is_piece and _is_component(prim)):
            yield prim
            below.PruneChildren()


class _Templates:
    """Object configurations, one for each model and mass."""

    def __init__(self, stage: Usd.Stage, folder: Path, frames: Frames) -> None:
        self._stage, self._folder, self._frames = stage, folder, frames
        self._assets: dict[str, str] = {}
        self._names: dict[tuple[str, float], str] = {}

    def of(self, thing: Thing) -> str:
        """Handle of the template of a thing, which is written where it is the first."""
        key = (thing.model, round(thing.mass_kg, 3))
        if key not in self._names:
            asset = self._asset(thing)
            number = sum(model == thing.model for model, _ in self._names)
            name = f"{asset}_{number + 1}" if number else asset
            self._names[key] = name
            _write(self._folder / f"{name}.object_config.json", self._template(thing, asset))
        return f"objects/{self._names[key]}"

    def _asset(self, thing: Thing) -> str:
        """Stem of the files of its model."""
        if thing.model not in self._assets:
            name, taken = thing.name, set(self._assets.values())
            number = 1
            while name in taken:
                number += 1
                name = f"{thing.name}_look_{number}"
            self._assets[thing.model] = name
            write_glb(self._stage, self._folder / f"{name}.glb", TEXTURE_PX, root=thing.prim)
            collider = self._collider(thing.prim)
            if collider is not None:
                collider.export(self._folder / f"{name}.collision.glb")
        return self._assets[thing.model]

    def _collider(self, prim: Usd.Prim) -> trimesh.Scene | None:
        """Convex parts that collide, in the frame of the prim, Y up; None for what has none."""
        scene = trimesh.Scene()
        for part in Usd.PrimRange(prim, _PROXIES):
            if part.HasAPI(UsdPhysics.CollisionAPI):
                solid = _convex(part)
                if solid is not None:
                    scene.add_geometry(solid, transform=Y_UP @ self._frames.within(part, prim))
        return scene if scene.geometry else None

    def _template(self, thing: Thing, asset: str) -> dict[str, Any]:
        has_collider = (self._folder / f"{asset}.collision.glb").is_file()
        solid = f"{asset}.collision.glb" if has_collider else f"{asset}.glb"
        template: dict[str, Any] = {"render_asset": f"{asset}.glb", "collision_asset": solid}
        template |= _UPRIGHT | {"join_collision_meshes": False, "is_collidable": has_collider}
        if thing.mass_kg > 0.0:
            template["mass"] = round(thing.mass_kg, 4)
        if thing.category in _SEMANTIC_IDS:
            template["semantic_id"] = _SEMANTIC_IDS[thing.category]
        return template | {"user_defined": {"class": thing.category}}


def _convex(part: Usd.Prim) -> trimesh.Trimesh | None:
    """A collider in its own frame: a box, or the hull of a mesh."""
    if part.IsA(UsdGeom.Cube):
        return trimesh.creation.box([float(UsdGeom.Cube(part).GetSizeAttr().Get())] * 3)
    points = UsdGeom.PointBased(part).GetPointsAttr().Get() if part.IsA(UsdGeom.Mesh) else None
    if points is None or len(points) < 4:
        return None
    return trimesh.convex.convex_hull(np.array(points, dtype=np.float64))


def _instance(thing: Thing, templates: _Templates, frames: Frames) -> dict[str, Any]:
    """A thing where it stands."""
    matrix = frames.of(thing.prim)
    scale = scale_of(matrix)
    if scale is None:
        raise StageError(
            f"{thing.prim.GetPath()} is skewed", expected="things that are moved, turned, scaled"
        )
    turn = Y_UP[:3, :3] @ rigid(matrix)[:3, :3] @ Y_UP[:3, :3].T
    x, y, z, w = Rotation.from_matrix(turn).as_quat()
    length, width, height = scale
    return {
        "template_name": templates.of(thing),
        "translation": _turned(matrix[:3, 3]),
        "rotation": _rounded([w, x, y, z]),
        "non_uniform_scale": _rounded([length, height, width]),
        "translation_origin": "asset_local",
        "motion_type": thing.motion,
        "user_defined": {"path": str(thing.prim.GetPath()), "class": thing.category},
    }


def _lights(stage: Usd.Stage, frames: Frames) -> Iterator[tuple[str, dict[str, Any]]]:
    """Lamps and the sun, at the brightness that a .glb has them; Habitat knows no spots."""
    for prim in stage.Traverse():
        light = light_of(prim) if prim.HasAPI(UsdLux.LightAPI) else None
        if light is None:
            continue
        pose = frames.of(prim)
        entry = {"color": light["color"], "intensity": round(light["intensity"] / LUX_PER_UNIT, 4)}
        if light["type"] == "directional":
            entry |= {"type": "directional", "direction": _turned(-rigid(pose)[:3, 2])}
        else:
            entry |= {"type": "point", "position": _turned(pose[:3, 3])}
        yield prim.GetName(), entry | {"position_model": "global"}


def _semantics(stage: Usd.Stage) -> dict[str, Any]:
    """Rooms as regions, and the classes by their ids."""
    regions = []
    for scene in read_storeys(stage):
        floor_m = scene.elevation_m
        for room in scene.graph.rooms:
            outline = np.asarray(room.polygon_m)
            loop = [_turned((x, y, floor_m)) for x, y in outline]
            corners = np.array(loop, dtype=np.float64)
            low, high = corners.min(axis=0), corners.max(axis=0)
            high[1] += ROOM_HEIGHT_M
            regions.append({
                "name": room.id.rsplit("/", 1)[-1], "label": room.kind, "poly_loop": loop,
                "floor_height": round(floor_m, 4), "extrusion_height": ROOM_HEIGHT_M,
                "min_bounds": _rounded(low), "max_bounds": _rounded(high),
            })  # fmt: skip
    classes = [{"id": number, "name": name} for name, number in _SEMANTIC_IDS.items()]
    return {"region_annotations": regions, "classes": classes}


@contextmanager
def _hidden(stage: Usd.Stage, prims: Sequence[Usd.Prim]) -> Iterator[None]:
    """The stage without these prims, its lights and its cameras, while this lasts."""
    layer = Sdf.Layer.CreateAnonymous()
    stage.GetSessionLayer().subLayerPaths.append(layer.identifier)
    with Usd.EditContext(stage, layer):
        lights = [prim for prim in stage.Traverse() if prim.HasAPI(UsdLux.LightAPI)]
        cameras = [prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Camera)]
        for prim in (*prims, *lights, *cameras):
            prim.SetActive(False)
    try:
        yield
    finally:
        stage.GetSessionLayer().subLayerPaths.remove(layer.identifier)


def _is_component(prim: Usd.Prim) -> bool:
    return bool(Usd.ModelAPI(prim).GetKind() == "component")


def _turned(at: Sequence[float] | FloatArray) -> list[float]:
    """A point or a direction, Y up."""
    turned: FloatArray = Y_UP[:3, :3] @ np.asarray(at, dtype=np.float64)
    return _rounded(turned)


def _rounded(values: Sequence[float] | FloatArray) -> list[float]:
    return [round(float(value), 6) for value in values]


def _write(path: Path, record: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
