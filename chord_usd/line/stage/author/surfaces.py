"""Plain materials: the one table of the shell's own surfaces, written as UsdPreviewSurface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from pxr import Gf, Sdf

from chord_usd.base.scene.feels import FEEL_OF_SURFACE
from chord_usd.base.scene.style_finishes import metal_like
from chord_usd.base.scene.styles import Agreed, HomeStyle, InnerDoor
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.physics import write_feel
from chord_usd.line.stage.author.prims import Types, attribute, define, label


@dataclass(frozen=True)
class Surface:
    """A surface without textures."""

    rgb: tuple[int, int, int]
    """sRGB, 0 to 255."""
    roughness: float
    metallic: float = 0.0
    opacity: float = 1.0


PLAIN_SURFACES: dict[str, Surface] = {
    "Ceiling": Surface((243, 242, 239), 0.9),
    "Trim": Surface((240, 239, 235), 0.35),
    "WindowFrame": Surface((226, 226, 224), 0.3),
    "EntranceDoor": Surface((74, 84, 80), 0.4),
    "Metal": Surface((176, 174, 170), 0.28, metallic=1.0),
    "Glass": Surface((24, 28, 27), 0.0, opacity=0.08),  # a pale one would be a veil in the sun
    "Facade": Surface((222, 217, 208), 0.9),
    "WallTop": Surface((58, 58, 60), 0.9),
    "RoofTiles": Surface((124, 72, 56), 0.8),
    "PlainFloor": Surface((182, 152, 118), 0.5),
    "PlainWall": Surface((236, 233, 226), 0.85),
    "Placeholder": Surface((178, 178, 182), 0.6),
}


@dataclass(frozen=True)
class Fitout:
    """What the shell of a home is finished with."""

    surfaces: Mapping[str, Surface] = field(default_factory=lambda: PLAIN_SURFACES)
    """What has no look, such as ceilings and skirting."""
    doors: InnerDoor = "panel"


_LEVERS = {
    "chrome": PLAIN_SURFACES["Metal"],
    "brass": Surface((188, 150, 88), 0.3, metallic=1.0),
    "black_metal": Surface((34, 34, 36), 0.45, metallic=0.6),
}


def fitout(style: HomeStyle, home: Agreed) -> Fitout:
    """Ceilings, trim, window frames and doors of a style; levers of the home's metal."""
    own = {"Ceiling": style.ceiling, "Trim": style.trim, "WindowFrame": style.frames}
    coloured = {
        name: replace(PLAIN_SURFACES[name], rgb=(int(c[1:3], 16), int(c[3:5], 16), int(c[5:7], 16)))
        for name, c in own.items()
    }
    levers = {"Metal": _LEVERS[metal_like(home.metal)]}
    return Fitout({**PLAIN_SURFACES, **coloured, **levers}, style.doors)


def write_surface(layer: Sdf.Layer, path: Sdf.Path, surface: Surface) -> None:
    """A material that looks like this surface."""
    material = define(layer, path, "Material")
    label(material, "material", path.name)
    shade(layer, material, surface)
    write_feel(material, FEEL_OF_SURFACE[path.name])


def shade(layer: Sdf.Layer, material: Sdf.PrimSpec, surface: Surface) -> None:
    """Give a material the shader of this surface."""
    shader = define(layer, material.path.AppendChild("PreviewSurface"), "Shader")
    attribute(shader, "info:id", Types.Token, "UsdPreviewSurface", uniform=True)
    color = Gf.Vec3f(*(linear_from_srgb(value) for value in surface.rgb))
    attribute(shader, "inputs:diffuseColor", Types.Color3f, color)
    attribute(shader, "inputs:roughness", Types.Float, surface.roughness)
    attribute(shader, "inputs:metallic", Types.Float, surface.metallic)
    attribute(shader, "inputs:opacity", Types.Float, surface.opacity)
    Sdf.AttributeSpec(shader, "outputs:surface", Types.Token)
    output = Sdf.AttributeSpec(material, "outputs:surface", Types.Token)
    source = shader.path.StripAllVariantSelections().AppendProperty("outputs:surface")
    output.connectionPathList.explicitItems.append(source)


def linear_from_srgb(level: int) -> float:
    """sRGB level 0 to 255 to linear light 0 to 1, which USD colours hold (IEC 61966-2-1)."""
    value = level / 255.0
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)


FLOOR = "_Floor"
"""Names of materials of floors end so."""


def floor_material(room: NamedRoom) -> str:
    """Name of the room's floor material; unique in the house, since Blender merges by name."""
    return f"{room.name}{FLOOR}"


def wall_material(room: NamedRoom) -> str:
    """Name of the room's wall material."""
    return f"{room.name}_Wall"
