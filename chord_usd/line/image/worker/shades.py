"""What light shines through: shades of lamps, and thin curtains.

UsdPreviewSurface knows neither. Shades let the light of their bulb out and glow while it shines;
curtains that one can see through scatter the day into the room.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from chord_usd.line.image.job import Job

GLOWING = ("Shade", "Opal", "Bulb", "Paper", "Glow")
"""How the names of materials of lamps begin that glow; screens are not among them."""

SHADE_WHITE = 1.7
"""Scene-linear luminance of a lit shade after exposure: bright, and still of its colour."""

BULB_WHITE = 6.0
_DARK = 0.02
"""What is left of the glow while no lamp shines."""

_THIN = (0.3, 0.95)
"""Opacity of cloth that one can see through."""

_THROUGH = 0.55
"""Share of the light on a thin cloth that comes out behind it."""

_WARM = (1.0, 0.72, 0.42)
"""Linear colour of a lit shade, as lamps of 2800 K have it after white balance."""


class Shades:
    """The shades of one house."""

    def __init__(self, job: Job) -> None:
        self._glowing = list(_glowing()) if job.rooms else []
        if not job.rooms:
            return
        names = {material.name for material, _ in self._glowing}
        for thing in bpy.data.objects:
            if thing.type == "MESH" and any(slot.name in names for slot in thing.material_slots):
                thing.visible_shadow = False
        for material in bpy.data.materials:
            _let_through(material)

    def glow(self, exposure_ev: float) -> None:
        """Bring shades to what film can show at this exposure, if any lamp shines."""
        lit = any(
            thing.type == "LIGHT" and thing.data.type == "POINT" and thing.data.energy > 0.0
            for thing in bpy.data.objects
        )
        for material, surface in self._glowing:
            white = BULB_WHITE if material.name.startswith("Bulb") else SHADE_WHITE
            strength = white * 2.0**-exposure_ev if lit else _DARK
            surface.inputs["Emission Strength"].default_value = strength

    def dim(self) -> None:
        """Take the glow away, as long as no exposure is known."""
        for _, surface in self._glowing:
            surface.inputs["Emission Strength"].default_value = _DARK


def _glowing() -> Iterator[tuple[Any, Any]]:
    """Materials of shades with their surface."""
    for material in bpy.data.materials:
        surface = _surface(material) if material.name.startswith(GLOWING) else None
        if surface is None:
            continue
        colour = surface.inputs["Emission Color"]
        if colour.is_linked or not max(colour.default_value[:3]):
            continue
        red, green, blue = colour.default_value[:3]
        top = max(red, green, blue)
        warm = (part * level / top for part, level in zip(_WARM, (red, green, blue), strict=True))
        colour.default_value = (*warm, 1.0)
        yield material, surface


def _let_through(material: Any) -> None:
    """Let light that falls on thin cloth come out behind it, too."""
    surface = _surface(material)
    if surface is None or surface.inputs["Alpha"].is_linked:
        return
    alpha = surface.inputs["Alpha"].default_value
    rough = surface.inputs["Roughness"]
    if not _THIN[0] <= alpha <= _THIN[1] or rough.is_linked or rough.default_value < 0.6:
        return
    tree = material.node_tree
    output = next((node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"), None)
    if output is None:
        return
    matte, behind = (tree.nodes.new(f"ShaderNodeBsdf{name}") for name in ("Diffuse", "Translucent"))
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    cloth, thin = (tree.nodes.new("ShaderNodeMixShader") for _ in range(2))
    colour = surface.inputs["Base Color"]
    for sheet in (matte, behind):
        if colour.is_linked:
            tree.links.new(colour.links[0].from_socket, sheet.inputs["Color"])
        else:
            sheet.inputs["Color"].default_value = colour.default_value
    cloth.inputs[0].default_value, thin.inputs[0].default_value = _THROUGH, alpha
    for mix, first, second in ((cloth, matte, behind), (thin, clear, cloth)):
        tree.links.new(first.outputs[0], mix.inputs[1])
        tree.links.new(second.outputs[0], mix.inputs[2])
    tree.links.new(thin.outputs[0], output.inputs["Surface"])


def _surface(material: Any) -> Any:
    tree = material.node_tree
    return tree and next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
