"""What surfaces look like to light that comes from another one, instead of to the camera.

Half of the time of a path goes into textures, normal maps and highlights of surfaces that it only
meets on its way; light that was scattered blurs them all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import bpy
import numpy as np
from mathutils import Color

_METAL = 0.1
"""Surfaces more metallic than this keep their looks: a mirror must go on mirroring."""

_PROBES = 997
"""Pixels of a texture that are averaged; a prime, so that no pattern hides between."""

_GLOSS = 0.03
"""Share of light from all around that a highlight returns. Measured on a black plane under an even
sky, at a roughness of 0.9: Cycles blurs all highlights that scattered light meets."""


def make_bounces_matte() -> None:
    """Let scattered light meet each opaque surface as matte, in the mean colour of its texture."""
    means: dict[str, tuple[float, float, float]] = {}
    for material in bpy.data.materials:
        tree = material.node_tree
        if tree is None:
            continue
        output = next((node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"), None)
        surface = next((node for node in tree.nodes if node.type == "BSDF_PRINCIPLED"), None)
        if output is None or surface is None or not output.inputs["Surface"].is_linked:
            continue
        colour = _plain_colour(surface, means)
        if colour is not None:
            _split(tree, output, _with_gloss(colour))


def _split(tree: Any, output: Any, colour: tuple[float, float, float]) -> None:
    """Put a switch before a surface; Cycles evaluates only the side it is turned to."""
    seen = output.inputs["Surface"].links[0].from_socket
    ray = tree.nodes.new("ShaderNodeLightPath")
    matte = tree.nodes.new("ShaderNodeBsdfDiffuse")
    matte.inputs["Color"].default_value = (*colour, 1.0)
    switch = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(ray.outputs["Is Diffuse Ray"], switch.inputs[0])
    tree.links.new(seen, switch.inputs[1])
    tree.links.new(matte.outputs[0], switch.inputs[2])
    tree.links.new(switch.outputs[0], output.inputs["Surface"])


def _plain_colour(surface: Any, means: dict[str, Any]) -> tuple[float, float, float] | None:
    """Linear colour of a surface; None for metal, glass, glowing and unknown surfaces."""
    sockets = surface.inputs
    if any(sockets[name].is_linked for name in ("Metallic", "Alpha", "Emission Color")):
        return None
    glows = sockets["Emission Strength"].default_value * max(
        sockets["Emission Color"].default_value[:3]
    )
    if sockets["Metallic"].default_value > _METAL or sockets["Alpha"].default_value < 1.0 or glows:
        return None
    if sockets["Transmission Weight"].default_value:
        return None
    colour = sockets["Base Color"]
    if not colour.is_linked:
        red, green, blue = colour.default_value[:3]
        return red, green, blue
    texture, scale, bias = _picture_of(colour.links[0].from_node)
    if texture is None:
        return None
    name = texture.image.name
    if name not in means:
        means[name] = _mean(texture.image)
    if means[name] is None:
        return None
    red, green, blue = (
        min(max(mean * factor + more, 0.0), 1.0)
        for mean, factor, more in zip(means[name], scale, bias, strict=True)
    )
    return red, green, blue


def _picture_of(node: Any) -> tuple[Any, Sequence[float], Sequence[float]]:
    """The image texture behind a colour, and the scale and bias that the importer puts after it
    where a stage says so; None for the texture of anything else."""
    scale, bias = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
    if node.type == "VECT_MATH" and node.operation == "MULTIPLY_ADD" and node.inputs[0].is_linked:
        if node.inputs[1].is_linked or node.inputs[2].is_linked:
            return None, scale, bias
        scale, bias = node.inputs[1].default_value[:], node.inputs[2].default_value[:]
        node = node.inputs[0].links[0].from_node
    is_picture = node.type == "TEX_IMAGE" and node.image is not None
    return node if is_picture else None, scale, bias


def _with_gloss(colour: tuple[float, float, float]) -> tuple[float, float, float]:
    """What a surface returns with its highlight; else rooms are darker by a level of 255."""
    red, green, blue = (channel + _GLOSS * (1.0 - channel) for channel in colour)
    return red, green, blue


def _mean(image: Any) -> tuple[float, float, float] | None:
    """Mean linear colour; None for a picture in a colour space we do not know."""
    space = image.colorspace_settings.name
    if space not in ("sRGB", "Non-Color", "Linear Rec.709"):
        return None
    rgba = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
    image.pixels.foreach_get(rgba)
    probes = rgba.reshape(-1, image.channels)[:: max(1, len(rgba) // image.channels // _PROBES), :3]
    if probes.shape[1] < 3:
        return None
    if space == "sRGB":
        probes = np.array([Color(rgb).from_srgb_to_scene_linear() for rgb in probes])
    red, green, blue = (float(channel) for channel in probes.mean(axis=0))
    return red, green, blue
