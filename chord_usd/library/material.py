"""Materials of components: UsdPreviewSurface networks, and what a colourway makes of them."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.files import link_or_copy
from chord_usd.library.surfaces.finishes import Finish
from chord_usd.library.surfaces.physical import stuff_of
from chord_usd.library.surfaces.surface_maps import (
    MAP_PX,
    ROUGHNESS_RANGE,
    MapFiles,
    has_maps,
    map_files,
)

if TYPE_CHECKING:
    from pxr import Usd, UsdShade

TEXTURES = "textures"
"""Folder of the pictures of a component, beside its payload."""

LOOK = "chord:look"
"""Attribute of a material: the name of its finish and a digest of all that it says, by which
materials of many components are known as one."""

_INPUTS = ("diffuseColor", "roughness", "metallic", "opacity", "emissiveColor")

_MAPS = (
    ("BaseColor", "diffuseColor", "rgb", "sRGB"),
    ("Roughness", "roughness", "r", "raw"),
    ("Normal", "normal", "rgb", "raw"),
)
"""Shader of a map, the input of the surface that it feeds, its output, its colour space."""


_PICTURE, _CONNECT, _WIRE = "Texture", "connect", ".connect"

Values = dict[str, tuple[str, Any]]
"""Property of a shader ("Surface.inputs:roughness"), or of the material itself (".doubleSided"), to
its USD type and value; of type "connect"
("Surface.inputs:roughness.connect"), the output it reads, or None for none."""


@dataclass(frozen=True)
class MapShelf:
    """Where the maps of finishes lie, and how large they are."""

    folder: Path
    px: int = MAP_PX

    def files(self, finish: Finish) -> MapFiles | None:
        """The maps of a finish, drawn if need be; None where it has none. Raises OSError."""
        return map_files(finish, self.folder, self.px) if has_maps(finish) else None


@dataclass(frozen=True, eq=False)
class Looks:
    """The finishes of a slot, one for each colourway, and their maps."""

    finishes: Sequence[Finish]
    names: Sequence[str]
    maps: Sequence[MapFiles | None]
    pictures: Sequence[str]
    """Names of picture files in TEXTURES; empty where a finish has none."""
    inputs: Sequence[Values] = field(init=False)
    """For each colourway."""

    def __post_init__(self) -> None:
        sources = zip(self.finishes, self.maps, self.pictures, strict=True)
        inputs = [_inputs(*source) for source in sources]
        for name, values in zip(self.names, inputs, strict=True):
            values[f".{LOOK}"] = ("String", f"{name}_{_digest(values)}")
        object.__setattr__(self, "inputs", inputs)

    def common(self) -> Values:
        """What is the same in all colourways."""
        return {k: value for k, value in self._whole.items() if k not in self._varying}

    def choice(self, index: int) -> Values:
        """What a colourway says: all in which colourways differ. What is missing in one of them
        (the maps of a plain finish) is as in another, since nothing reads it."""
        said = self._whole | self.inputs[index]
        return {k: said[k] for k in self._whole if k in self._varying}

    def overrides(self, index: int) -> Values:
        """Values of a finish over the values of colourways; missing values stay as they are."""
        return {k: value for k, value in self.inputs[index].items() if k in self._varying}

    @cached_property
    def _varying(self) -> set[str]:
        """Names of the inputs that are not the same in all colourways that have them."""
        first: Values = {}
        each = [(name, value) for values in self.inputs for name, value in values.items()]
        return {name for name, value in each if first.setdefault(name, value) != value}

    @cached_property
    def _whole(self) -> Values:
        """What the first colourway says and, where it is silent, others do: files for all."""
        whole: Values = {}
        for values in reversed(self.inputs):
            whole |= values
        if self.is_drawn:
            return whole
        return {name: value for name, value in whole.items() if not name.endswith(_WIRE)}

    @property
    def is_drawn(self) -> bool:
        """Whether any colourway has maps or a picture."""
        return any(self.maps) or any(self.pictures)


def slot_looks(
    design_id: str, slot: str, finishes: Sequence[tuple[str, Finish]], shelf: MapShelf
) -> Looks:
    """The looks of a slot, their maps drawn. Raises OSError.

    finishes: with their names, of each colourway.

    Pictures are named after the design, too: Blender unpacks all of a .usdz into one folder.
    """
    pictures: dict[int, str] = {}
    names, worn = [name for name, _ in finishes], [finish for _, finish in finishes]
    for finish in worn:
        if finish.texture is not None:
            number = f"_{len(pictures) + 1}" if pictures else ""
            pictures.setdefault(id(finish.texture), f"{design_id}_{slot}{number}.jpg")
    shown = [pictures.get(id(finish.texture), "") for finish in worn]
    return Looks(worn, names, [shelf.files(finish) for finish in worn], shown)


def save_pictures(looks: Looks, shelf: MapShelf, folder: Path) -> None:
    """Write the pictures of a slot into folder; its maps are links to those on the shelf."""
    for maps in looks.maps:
        for name in (maps.colour, maps.roughness, maps.normal) if maps else ():
            if not (folder / name).exists():
                folder.mkdir(exist_ok=True)
                link_or_copy(shelf.folder / name, folder / name)
    for name, finish in zip(looks.pictures, looks.finishes, strict=True):
        if finish.texture is not None and not (folder / name).exists():
            folder.mkdir(exist_ok=True)
            finish.texture.save(folder / name, quality=88)


def define_material(stage: Usd.Stage, path: str, looks: Looks) -> None:
    """A UsdPreviewSurface with what all colourways share; with maps where any has them.

    Blender does not follow inputs of the material itself, so all values are the shaders' own.
    Constants stay under the maps: they are the mean, for what reads no pictures.
    """
    from pxr import Sdf, UsdSemantics, UsdShade

    material = UsdShade.Material.Define(stage, path)
    UsdSemantics.LabelsAPI.Apply(material.GetPrim(), "material")
    shader = UsdShade.Shader.Define(stage, f"{path}/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("ior", Sdf.ValueTypeNames.Float).Set(1.5)
    if looks.is_drawn:
        uv = _coordinates(stage, path)
        if any(looks.maps):
            _define_maps(stage, path, uv)
        if any(looks.pictures):
            _texture(stage, f"{path}/{_PICTURE}", "sRGB", uv, "rgb")
    write_values(stage, path, looks.common())
    surface = shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
    material.CreateSurfaceOutput().ConnectToSource(surface)


def _digest(values: Values) -> str:
    return hashlib.sha256(repr(sorted(values.items())).encode()).hexdigest()[:8]


def _inputs(finish: Finish, maps: MapFiles | None, picture: str) -> Values:
    from pxr import Gf, Sdf

    colour = Gf.Vec3f(*finish.linear_rgb())
    values = (
        ("Color3f", colour),
        ("Float", finish.roughness),
        ("Float", finish.metallic),
        ("Float", finish.opacity),
        ("Color3f", colour * finish.glow),
    )
    named = dict(zip(_INPUTS, values, strict=True))
    inputs: Values = {f"Surface.inputs:{k}": v for k, v in named.items()}
    inputs[".semantics:labels:material"] = ("TokenArray", [stuff_of(finish)])
    for shader, fed, output, _ in _MAPS:
        source = f"{shader}.outputs:{output}" if maps else None
        inputs[f"Surface.inputs:{fed}{_WIRE}"] = (_CONNECT, source)
    if picture:
        inputs[f"Surface.inputs:diffuseColor{_WIRE}"] = (_CONNECT, f"{_PICTURE}.outputs:rgb")
        inputs[f"{_PICTURE}.inputs:file"] = ("Asset", Sdf.AssetPath(f"./{TEXTURES}/{picture}"))
    if maps is None:
        return inputs
    for (shader, *_), name in zip(_MAPS, (maps.colour, maps.roughness, maps.normal), strict=True):
        inputs[f"{shader}.inputs:file"] = ("Asset", Sdf.AssetPath(f"./{TEXTURES}/{name}"))
    inputs["Roughness.inputs:scale"] = ("Float4", Gf.Vec4f(ROUGHNESS_RANGE * finish.roughness))
    repeats = Gf.Vec2f(1.0 / maps.tile_m[0], 1.0 / maps.tile_m[1])
    inputs["Place.inputs:scale"] = ("Float2", repeats)
    return inputs


def _define_maps(stage: Usd.Stage, path: str, coordinates: UsdShade.Output) -> None:
    """The shaders of the maps, which all lie the same way over metres."""
    from pxr import Gf, Sdf, UsdShade

    types = Sdf.ValueTypeNames
    place = UsdShade.Shader.Define(stage, f"{path}/Place")
    place.CreateIdAttr("UsdTransform2d")
    place.CreateInput("in", types.Float2).ConnectToSource(coordinates)
    uv = place.CreateOutput("result", types.Float2)
    for name, _, output, space in _MAPS:
        shader = _texture(stage, f"{path}/{name}", space, uv, output)
        if name == "Normal":
            # For colourways without maps: Blender complains of an input without a value.
            surface = UsdShade.Shader.Get(stage, f"{path}/Surface")
            surface.CreateInput("normal", types.Normal3f).Set(Gf.Vec3f(0.0, 0.0, 1.0))
            shader.CreateInput("scale", types.Float4).Set(Gf.Vec4f(2.0, 2.0, 2.0, 1.0))
            shader.CreateInput("bias", types.Float4).Set(Gf.Vec4f(-1.0, -1.0, -1.0, 0.0))


def _coordinates(stage: Usd.Stage, path: str) -> UsdShade.Output:
    from pxr import Sdf, UsdShade

    reader = UsdShade.Shader.Define(stage, f"{path}/Uv")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    return reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)


def _texture(
    stage: Usd.Stage, path: str, space: str, uv: UsdShade.Output, output: str
) -> UsdShade.Shader:
    from pxr import Sdf, UsdShade

    types = Sdf.ValueTypeNames
    texture = UsdShade.Shader.Define(stage, path)
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", types.Asset)
    texture.CreateInput("sourceColorSpace", types.Token).Set(space)
    for side in ("wrapS", "wrapT"):
        texture.CreateInput(side, types.Token).Set("repeat")
    texture.CreateInput("st", types.Float2).ConnectToSource(uv)
    texture.CreateOutput(output, types.Float if output == "r" else types.Float3)
    return texture


def write_values(stage: Usd.Stage, path: str, values: Values) -> None:
    """Say in the stage's edit target what the shaders of one material have and read."""
    from pxr import Sdf

    for name, (type_name, value) in values.items():
        shader, _, property_ = name.partition(".")
        prim = stage.OverridePrim(f"{path}/{shader}" if shader else path)
        if type_name == _CONNECT:
            attribute = _connected(prim, property_.removesuffix(_WIRE))
            attribute.SetConnections([Sdf.Path(f"{path}/{value}")] if value else [])
        else:
            kind = getattr(Sdf.ValueTypeNames, type_name)
            prim.CreateAttribute(property_, kind, custom=property_ == LOOK).Set(value)


def _connected(prim: Usd.Prim, name: str) -> Usd.Attribute:
    from pxr import Sdf

    types = Sdf.ValueTypeNames
    kinds = {"diffuseColor": types.Color3f, "roughness": types.Float, "normal": types.Normal3f}
    return prim.CreateAttribute(name, kinds[name.removeprefix("inputs:")], custom=False)
