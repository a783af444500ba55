"""Layers over a stage for one picture, which leave the stage itself alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import RenderError
from chord_usd.base.raster.hdri import developed, require_picture
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.runtime.stages import open_layer, open_stage
from chord_usd.base.scene.skies import Sky, dome_turn_deg, sky_named

if TYPE_CHECKING:
    from pxr import Sdf

LIGHTING, ROOF = "lighting", "roof"
"""Variant sets of the default prim."""

_KEPT = ("defaultPrim", "upAxis", "metersPerUnit", "renderSettingsPrimPath")
"""Metadata that a stage takes from its topmost layer alone."""


@contextmanager
def lit_stage(path: Path, lighting: str, sky: str = "", roof: str = "") -> Iterator[Path]:
    """Yield a stage with these choices of its variant sets `lighting` and `roof` and under this
    sky; "" for all yields the stage itself.

    sky: as scene.skies.sky_named takes it; where lighting is "", it is that of the sky's time. It
    is a layer over the stage, thrown away afterwards. Raises StageError for a stage that cannot be
    read, ChordError for what is no sky, RenderError with the choices there are.
    """
    from pxr import Sdf

    if not lighting and not sky and not roof:
        yield path
        return
    wanted = sky_named(sky) if sky else None
    if wanted is not None:
        require_picture(wanted)
    lighting = lighting or (wanted.time if wanted else "")
    chosen = {name: variant for name, variant in ((LIGHTING, lighting), (ROOF, roof)) if variant}
    house = _check(path, chosen)
    with layer_over(path) as (layer, file):
        prim = Sdf.PrimSpec(layer, house, Sdf.SpecifierOver)
        for name, variant in chosen.items():
            prim.variantSelections[name] = variant
        if wanted is not None:
            _hang_sky(prim, wanted, _sun_yaw_deg(path), file.parent)
        layer.Save()
        yield file


def _sun_yaw_deg(path: Path) -> float:
    """Direction of the stage's sun. Raises RenderError for a stage that chord-usd did not write."""
    stage = open_stage(path, load=False)
    place = stage.GetDefaultPrim().GetPath().AppendPath("Lighting.chord:sun_yaw_deg")
    noted = stage.GetAttributeAtPath(place)
    if not noted:
        raise RenderError(
            "has no sky that another could take the place of",
            where=str(path),
            expected="a house that chord-usd wrote",
        )
    return float(noted.Get())


def _hang_sky(house: Sdf.PrimSpec, sky: Sky, yaw_deg: float, folder: Path) -> None:
    """Write another sky over the house's own."""
    from pxr import Gf, Sdf

    picture = developed(sky)
    if picture is None:
        raise RenderError("the sky's HDRI is not on this machine", try_="pip install bpy")
    file = folder / "sky.exr"
    file.write_bytes(picture.exr)
    sky, types = picture.sky, Sdf.ValueTypeNames
    scope = Sdf.PrimSpec(house, "Lighting", Sdf.SpecifierOver)
    dome = Sdf.PrimSpec(scope, "Sky", Sdf.SpecifierDef, "DomeLight")
    turn_deg = dome_turn_deg(sky.sun_at_deg, yaw_deg)
    _set(dome, "inputs:intensity", types.Float, sky.radiance)
    _set(dome, "inputs:texture:file", types.Asset, Sdf.AssetPath(f"./{file.name}"))
    _set(dome, "inputs:texture:format", types.Token, "latlong")
    _set(dome, "xformOp:rotateX", types.Double, 90.0)
    _set(dome, "xformOp:rotateZ", types.Double, turn_deg)
    _set(dome, "xformOpOrder", types.TokenArray, ["xformOp:rotateZ", "xformOp:rotateX"])
    sun = Sdf.PrimSpec(scope, "Sun", Sdf.SpecifierDef, "DistantLight")
    shining = sky.sun
    _set(sun, "inputs:intensity", types.Float, shining.irradiance if shining else 0.0)
    if shining:
        _set(sun, "inputs:angle", types.Float, 1.2)
        _set(sun, "inputs:normalize", types.Bool, True)
        _set(sun, "inputs:enableColorTemperature", types.Bool, True)
        _set(sun, "inputs:colorTemperature", types.Float, shining.kelvin)
        turn = Gf.Vec3f(90.0 - shining.height_deg, 0.0, yaw_deg + 90.0)
        _set(sun, "xformOp:rotateXYZ", types.Float3, turn)
        _set(sun, "xformOpOrder", types.TokenArray, ["xformOp:rotateXYZ"])


def _set(prim: Sdf.PrimSpec, name: str, type_: Sdf.ValueTypeName, value: object) -> None:
    from pxr import Sdf

    Sdf.AttributeSpec(prim, name, type_).default = value


@contextmanager
def layer_over(path: Path) -> Iterator[tuple[Sdf.Layer, Path]]:
    """Yield an empty layer over a stage and its file, which goes away afterwards."""
    from pxr import Sdf

    below = open_layer(absolute(path))
    with scratch_folder() as folder:
        file = folder / "over.usda"
        layer = Sdf.Layer.CreateNew(str(file))
        layer.subLayerPaths.append(str(absolute(path)))
        for key in _KEPT:
            if below.pseudoRoot.HasInfo(key):
                layer.pseudoRoot.SetInfo(key, below.pseudoRoot.GetInfo(key))
        yield layer, file


def _check(path: Path, chosen: Mapping[str, str]) -> str:
    """Name of the prim with the variant sets."""
    stage = open_stage(path, load=False)
    house = stage.GetDefaultPrim()
    for name, variant in chosen.items():
        choices = house.GetVariantSet(name).GetVariantNames() if house else []
        if variant not in choices:
            some = f"one of {', '.join(choices)}" if choices else ""
            raise RenderError(
                f"has no {name} '{variant}'",
                where=str(path),
                expected=some or "a stage with such variants",
                try_=f"<roofed={variant}>" if name == ROOF and not choices else "",
            )
    return str(house.GetName())
