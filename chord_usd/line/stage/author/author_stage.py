"""SceneGraph -> StageFile: the house as a USD stage (design: House > Rooms > items)."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, UsdUtils

from chord_usd import __version__
from chord_usd.base.errors import OutputError
from chord_usd.base.raster.hdri import require_picture
from chord_usd.base.runtime.asset_stages import try_assets
from chord_usd.base.runtime.files import deliver, destination
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.articulation import FIXED
from chord_usd.base.scene.looks import LookSource
from chord_usd.base.scene.roof_forms import NO_ROOF, RoofForm
from chord_usd.base.scene.skies import Sky, sky_named
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.styles import MIXED, HomeStyle, style_named
from chord_usd.base.scene.types import FloatArray, SceneGraph, StageFile
from chord_usd.line.stage.author.attribution import write_attribution
from chord_usd.line.stage.author.design_notes import note_design
from chord_usd.line.stage.author.furniture import (
    DRESSING,
    FURNITURE,
    extent_of,
    place_dressing,
    place_furniture,
)
from chord_usd.line.stage.author.lighting import hang_lamps, hang_light, set_lighting
from chord_usd.line.stage.author.look_variants import assign_looks
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.physics import write_gravity
from chord_usd.line.stage.author.prims import (
    Types,
    apply_schema,
    attribute,
    define,
    define_class,
    dictionary,
    hint_extent,
    identify,
    inherit,
    label,
    new_layer,
    note,
    place,
    relate,
)
from chord_usd.line.stage.author.shared_looks import share_looks
from chord_usd.line.stage.author.stage_levels import SHAFT, Level, one_level, room_specs
from chord_usd.line.stage.author.surfaces import fitout
from chord_usd.line.stage.author.variants import Wardrobe
from chord_usd.line.stage.export.packages import Packages, share_pictures
from chord_usd.line.stage.shell.author_shell import draw_shell
from chord_usd.line.stage.views.cameras import set_cameras

SCHEMA = 1
"""Version of the structure and the `chord:` attributes; readers refuse a newer one."""

_RESOLUTION_PX = (1280, 720)
ARCHIVE_TIME_S = 500_000_000
"""Any fixed time that a zip archive can hold, so that the same house is the same archive."""


def author_stage(
    graph: SceneGraph,
    path: Path,
    *,
    seed: int = 0,
    looks: LookSource | None = None,
    style: str = "",
    sky: str = "",
    articulation: str = FIXED,
    roof: RoofForm = NO_ROOF,
) -> StageFile:
    """Write a house as a USD stage, with everything it points to beside it.

    Beside `house.usda` appear `house_architecture/`, `assets/` and `materials/`; houses of one
    folder share the latter two. `.usdz` packs all of it into one file. Same graph, same seed: same
    bytes. Nothing is left behind on failure.

    looks: source of the looks of walls and floors; without, surfaces are plain. style: name of a
    style; by default that of the graph, and where that has none, one by the seed. sky: name of one
    (scene.skies), or an HDRI's file. articulation: whether doors and drawers of furniture open
    (scene.articulation). roof: what its variant set `roof` offers beside none (stage.roof).

    Raises ChordError for an unknown sky, PlanError for a roof that does not fit, SceneError for a
    graph without rooms or with an unknown category, AssetError for a missing mesh, OutputError for
    a target that cannot be written.
    """
    _refuse_odd_suffix(path)
    style = style or graph.style or MIXED
    return author_levels(
        [one_level(graph)], path, seed=seed, looks=looks, style=style, sky=sky,
        articulation=articulation, roof=roof,
    )  # fmt: skip


def author_levels(
    levels: Sequence[Level],
    path: Path,
    *,
    seed: int = 0,
    looks: LookSource | None = None,
    style: str = MIXED,
    sky: str = "",
    articulation: str = FIXED,
    roof: RoofForm = NO_ROOF,
    requests: Mapping[str, str] | None = None,
) -> StageFile:
    """Write the storeys of a house as one stage; everything else is as author_stage has it.

    requests: pieces that rooms must and must not hold, in words, by the names of their prims.
    """
    path = Path(path)
    _refuse_odd_suffix(path)
    named = style_named(style, seed)
    house = _House(tuple(levels), seed, looks, named, sky_named(sky), articulation, roof,
                   requests or {})  # fmt: skip
    require_picture(house.sky)
    try_assets(asset.usd_path for level in levels for asset in level.graph.assets())
    with deliver() as delivery:
        target = delivery.place(path)
        final = destination(path.parent)
        if path.suffix == ".usdz":
            content_hash = _pack(house, target, path)
        else:
            content_hash = _write_house(house, target, final)
            layer = open_layer(target)
            write_attribution(layer, (target.parent, final), target, path)
    _reload(path)
    return StageFile(path, content_hash, levels[0].graph.provenance)


def _refuse_odd_suffix(path: Path) -> None:
    if Path(path).suffix not in STAGE_SUFFIXES:
        raise OutputError(
            f"{Path(path).suffix or 'no suffix'} is no kind of stage",
            where=str(path),
            expected=f"one of {', '.join(STAGE_SUFFIXES)}",
        )


@dataclass(frozen=True, eq=False)
class _House:
    """What is to be written."""

    levels: tuple[Level, ...]
    """The lowest first."""
    seed: int
    looks: LookSource | None
    style: HomeStyle
    sky: Sky
    articulation: str
    roof: RoofForm
    requests: Mapping[str, str]

    @property
    def rooms(self) -> list[NamedRoom]:
        """Of all storeys."""
        return [room for level in self.levels for room in level.rooms]


def _write_house(house: _House, target: Path, final: Path) -> str:
    """Write the stage to target, which will end up in final; returns the content hash."""
    layer = _open_house(house, target)
    architecture = _architecture(target)
    architecture.mkdir()
    assets = Packages(target.parent, [final], "assets")
    materials = Packages(target.parent, [final], "materials")
    agreed = house.style.agreed(house.seed)
    finish = fitout(house.style, agreed)
    wardrobe = Wardrobe(house.seed, house.style, agreed, house.articulation)
    extents, lamps = [], []
    with tempfile.TemporaryDirectory(dir=target.parent) as scratch:
        for level, above in zip_longest(house.levels, house.levels[1:]):
            for room in level.rooms:
                _open_room(layer, room)
            extent = draw_shell(layer, level, architecture, finish, above)
            extents.append(extent + np.array([0.0, 0.0, level.elevation_m]))
            for room in level.rooms:
                place_furniture(layer, room, assets, Path(scratch), wardrobe)
                if level.graph.dressing:
                    place_dressing(layer, room, assets, Path(scratch), wardrobe)
                if room.room.id not in level.rising:  # those have no ceiling
                    lamps.append(hang_light(layer, room, level.walls))
                lamps += hang_lamps(layer, room.path, (target.parent, final))
            assign_looks(layer, level, house.looks, materials, house.seed)
    share_looks(layer, architecture)
    set_lighting(layer, lamps, house.levels[0].walls, architecture, house.sky)
    _order_prims(layer, house.rooms)
    set_cameras(layer, house.levels)
    _set_render(layer, house.rooms)
    _hint_house(layer, extents, house.levels)
    if house.roof != NO_ROOF:
        from chord_usd.line.stage.shell.roof import raise_roof

        raise_roof(layer, house.levels, house.roof, architecture, finish)
    note_design(layer, house.levels)
    for room in house.rooms:
        if asked := house.requests.get(room.name):
            note(layer.GetPrimAtPath(f"{room.path}/{FURNITURE}"), requests=asked)
    layer.Save()
    return _hash([target, *sorted(architecture.iterdir())])


def _open_house(house: _House, target: Path) -> Sdf.Layer:
    """The layer with its metadata, the house and its groups."""
    layer = new_layer(target, "House")
    layer.pseudoRoot.SetInfo("renderSettingsPrimPath", "/House/Render/Settings")
    made = house.levels[0].graph.provenance
    layer.customLayerData = {
        "chord": dictionary(
            {
                "seed": house.seed,
                "style": house.style.name,
                "sky": house.sky.name,
                "articulation": house.articulation,
                "generator": f"chord-usd {__version__}",
                "schema": SCHEMA,
                "provenance": {
                    "inputHash": made.input_hash,
                    "checkpointHash": made.checkpoint_hash,
                    "seed": made.seed,
                    "version": made.version,
                    "configuration": json.dumps(
                        dict(made.configuration), sort_keys=True, default=str
                    ),
                },
            }
        )
    }
    root = define(layer, "/House", "Xform", kind="assembly")
    identify(root, "House", f"./{target.name}")
    inherit(root, define_class(layer, "House"))
    # Beside the house: two houses on one stage bring no two scenes.
    write_gravity(layer, "/PhysicsScene")
    define(layer, "/House/Rooms", "Xform", kind="group")
    if len(house.levels) > 1:
        define(layer, "/House/Exterior", "Xform", kind="group")
    for level in house.levels:
        if level.group:
            storey = define(layer, level.path, "Xform", kind="group", name=level.title)
            place(storey, at_m=(0.0, 0.0, level.elevation_m))
            label(storey, "category", "storey")
            note(storey, elevation_m=level.elevation_m)
    return layer


def _open_room(layer: Sdf.Layer, room: NamedRoom) -> None:
    prim = define(layer, room.path, "Xform", kind="group", name=room.room.name or room.name)
    inherit(prim, define_class(layer, "Room"))
    label(prim, "room", room.room.kind)
    note(prim, node_id=room.room.id, kind=room.room.kind, polygon_m=room.room.polygon_m)
    if room.group and is_cell(room.room):
        note(prim, category=SHAFT)


def _order_prims(layer: Sdf.Layer, rooms: Sequence[NamedRoom]) -> None:
    """In the order of the design, where variants would put theirs first."""
    for room in rooms:
        prim = layer.GetPrimAtPath(room.path)
        prim.nameChildrenOrder = ["Architecture", "Furniture", "Lights"]
    house = layer.GetPrimAtPath("/House")
    house.nameChildrenOrder = [
        "Rooms", "Exterior", "Ground", "Lighting", "Cameras", "Render"
    ]  # fmt: skip


def _set_render(layer: Sdf.Layer, rooms: Sequence[NamedRoom]) -> None:
    """Settings that a renderer finds through the layer's renderSettingsPrimPath."""
    define(layer, "/House/Render", "Scope")
    settings = define(layer, "/House/Render/Settings", "RenderSettings")
    attribute(settings, "resolution", Types.Int2, Gf.Vec2i(*_RESOLUTION_PX), uniform=True)
    first = next(room for room in rooms if layer.GetPrimAtPath(f"/House/Cameras/{room.name}"))
    relate(settings, "camera", [f"/House/Cameras/{first.name}"])
    relate(settings, "products", ["/House/Render/Product"])
    product = define(layer, "/House/Render/Product", "RenderProduct")
    attribute(product, "productName", Types.Token, "house.png")
    relate(product, "orderedVars", ["/House/Render/Product/Color"])
    color = define(layer, "/House/Render/Product/Color", "RenderVar")
    attribute(color, "dataType", Types.Token, "color3f", uniform=True)
    attribute(color, "sourceName", Types.String, "color", uniform=True)


def _hint_house(layer: Sdf.Layer, shells_m: Sequence[FloatArray], levels: Sequence[Level]) -> None:
    """Bounds and collections, once everything is in place."""
    house = layer.GetPrimAtPath("/House")
    extents = list(shells_m)
    for level in levels:
        if level.graph.items:
            extents.append(extent_of(level.graph.items) + np.array([0.0, 0.0, level.elevation_m]))
    bounds = np.array(extents)
    hint_extent(house, np.array([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)]))
    _collect(layer, FURNITURE)
    if any(level.graph.dressing for level in levels):
        _collect(layer, DRESSING)


def _collect(layer: Sdf.Layer, group: str) -> None:
    """A collection of the house: the groups of this name of all rooms."""
    house, name = layer.GetPrimAtPath("/House"), group.lower()
    apply_schema(house, f"CollectionAPI:{name}")
    groups = [room.nameChildren.get(group) for room in room_specs(layer)]
    relate(house, f"collection:{name}:includes", [spec.path for spec in groups if spec])


def _pack(house: _House, target: Path, final: Path) -> str:
    """Write the stage into a folder of its own and pack that into target, which becomes final."""
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        stage = Path(folder) / f"{target.stem}.usda"
        content_hash = _write_house(house, stage, Path(folder))
        write_attribution(open_layer(stage), (Path(folder),), target, final)
        share_pictures(Path(folder) / "assets")
        for file in Path(folder).rglob("*"):  # the archive notes their times
            os.utime(file, (ARCHIVE_TIME_S, ARCHIVE_TIME_S))
        UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(stage)), str(target))
    return content_hash


def _reload(path: Path) -> None:
    """Let stages that are open in this process see what was just written."""
    for file in [path, *_architecture(path).glob("*")]:
        layer = Sdf.Layer.Find(str(file))
        if layer:
            layer.Reload()


def _architecture(path: Path) -> Path:
    """Folder of the shell's layers, beside the stage; named after it, so that none clash."""
    return path.with_name(f"{path.stem}_architecture")


def _hash(files: Sequence[Path]) -> str:
    """SHA-256 over the bytes of the layers that make up the house."""
    digest = hashlib.sha256()
    for file in files:
        digest.update(file.read_bytes())
    return digest.hexdigest()
