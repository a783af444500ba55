"""A mesh of the database as a prop that simulators take by itself, after NVIDIA's SimReady.

    Desk_A/simready_usd/Desk_A.usda                            rigid body, mass, provenance
    Desk_A/simready_usd/.thumbs/256x256/Desk_A.usda.png        what browsers of assets show
    Desk_A/simready_usd/payloads/{Desk_A, Finishes}/           the component as it is

Profile Robotics-Prop 4.0.0: folders by NP.005, thumbnail SR.002, provenance SR.004, body RB.001.
"""

from __future__ import annotations

from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

from chord_usd.base.runtime.stages import open_known
from chord_usd.base.scene.articulation import ARTICULATION, FIXED, JOINTED
from chord_usd.base.scene.feels import CLOTH
from chord_usd.base.scene.label_sets import wikidata_item
from chord_usd.base.scene.types import Asset, Box, FloatArray
from chord_usd.line.stage.author.physics import give_body, usual_mass_kg, write_collider, write_feel
from chord_usd.line.stage.author.prims import add_variants, define, label, new_layer
from chord_usd.line.stage.export.packages import Packages

if TYPE_CHECKING:
    from PIL.Image import Image

FOLDER, PAYLOADS = "simready_usd", "payloads"
THUMBNAIL_PX = 256
"""Side of the picture."""

_UNKNOWN = "unknown"


def write_simready(asset: Asset, folder: Path, picture: Image, made: date) -> Path:
    """Write an asset into folder/asset.id, which must not be there; returns its root layer.

    picture: THUMBNAIL_PX square. made: what its provenance says it was made on. A piece that opens
    is one body in the variant `fixed`, and the bodies of its parts in `jointed`. Raises AssetError
    for an asset that cannot be read or points to files elsewhere.
    """
    place = folder / asset.id / FOLDER
    place.mkdir(parents=True)
    reference = Packages(place, [], PAYLOADS).add(asset.usd_path)
    source = open_known(place / reference)
    opens = source.GetDefaultPrim().GetVariantSet(ARTICULATION).IsValid()
    bounds_m = _bounds_m(source)
    mass_kg = usual_mass_kg(asset.category, tuple((bounds_m[1] - bounds_m[0]).tolist()))
    path = place / f"{asset.id}.usda"
    layer = new_layer(path, asset.id)
    root = define(layer, f"/{asset.id}", "Xform")
    root.referenceList.prependedItems.append(Sdf.Reference(reference))
    # Also where the component is an older one, or somebody else's.
    label(root, "category", asset.category)
    label(root, "wikidata_qcode", wikidata_item(asset.category))
    bodies = add_variants(root, ARTICULATION, (FIXED, JOINTED))[:1] if opens else [root]
    give_body(bodies[0], mass_kg)
    if not _is_felt(source):
        _write_felt_box(layer, root.path, bounds_m)
    layer.customLayerData = {"SimReady_Metadata": _provenance(asset, bounds_m, mass_kg, made)}
    layer.Save()
    thumbnail = place / f".thumbs/{THUMBNAIL_PX}x{THUMBNAIL_PX}/{path.name}.png"
    thumbnail.parent.mkdir(parents=True)
    picture.save(thumbnail, format="PNG")
    return path


def _bounds_m(stage: Usd.Stage) -> FloatArray:
    """(2, 3) of all that is seen."""
    purposes = [UsdGeom.Tokens.default_, UsdGeom.Tokens.render]
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), purposes)
    bounds = cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange()
    return np.array([bounds.GetMin(), bounds.GetMax()])


def _is_felt(stage: Usd.Stage) -> bool:
    return any(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in stage.Traverse())


def _write_felt_box(layer: Sdf.Layer, root: Sdf.Path, bounds_m: FloatArray) -> None:
    """What is soft or thin has no collider in a house, where it would only be in the way."""
    low, high = bounds_m
    x, y, _ = ((low + high) / 2).tolist()
    length, width, height = (high - low).tolist()
    define(layer, root.AppendChild("Felt"), "Scope")
    material = define(layer, root.AppendPath("Felt/Cloth"), "Material")
    write_feel(material, CLOTH)
    label(material, "material", "textile")
    box = Box((x, y, float(low[2])), (length, width, height), 0.0)
    write_collider(layer, root.AppendPath("Felt/Box"), box, material.path)


def _provenance(
    asset: Asset, bounds_m: FloatArray, mass_kg: float, made: date
) -> dict[str, object]:
    """The fields that SR.004 asks for."""
    return {
        "asset_name": asset.id,
        "asset_type": "prop",
        "author": asset.author or _UNKNOWN,
        "asset_license": asset.licence or _UNKNOWN,
        "category": asset.category,
        "qcode": wikidata_item(asset.category),
        "source_file": asset.usd_path.name,
        "usd_date_generated": made.isoformat(),
        "rigid_body_count": 1,
        "asset_extents": Gf.Vec3f(*(bounds_m[1] - bounds_m[0]).tolist()),
        "mass": round(mass_kg, 4),
    }
