"""What lies outside a house's windows: sky, ground and glass, and how bright a picture shows it.

By day the view is ten times as bright as the room. A photographer of interiors takes two pictures,
one exposed for the room and one for the view, and puts the second into the windows of the first.
So here: light comes in as it is, and only what the camera sees of sky and ground, by itself or in
a mirror, is held down to what film can show.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import Any

import bpy
import numpy as np

from chord_usd.line.image.job import Job

GROUND = "Ground"
"""Name of the prim above the ground."""

FACADES = "Exterior"
"""Name of the prim above the house's outside."""

GLASS = "Glass"
"""Names of panes start so."""

VIEW_WHITE = 1.25
"""Scene-linear luminance, after exposure, of the brighter part of the view: AgX still shows it
darker than white."""

_BRIGHTER = 70.0
"""Percentile that is held there."""

_LEAST = 0.04
"""Nothing is held down further than to this share."""

_BAND_DEG = (-4.0, 50.0)
"""Heights of sky that windows show, at most."""

_USUAL_BAND_DEG = (-4.0, 24.0)
_LEAST_BAND_DEG = 4.0
"""A pane that shows less of the sky does not count."""

_FADES_M = (25.0, 70.0)
"""Where the ground begins to give way to the picture of the sky, and where it has."""

_SAMPLED_PX = (128, 64)


class Outside:
    """The view of one house."""

    def __init__(self, scene: Any, job: Job) -> None:
        self.grounds = [thing for thing in _meshes() if _is_below(thing, GROUND)]
        self._world = scene.world
        self._light = _sky_light(scene.world) if job.rooms and job.has_dome else None
        self._holds: list[Any] = []
        self._facades: list[Any] = []
        self._panes = list(panes())
        if self._light is None:
            return
        self._holds.append(_dim_for_camera(scene.world))
        for ground in self.grounds:
            # The picture's own ground lights the rooms; this one is to be looked at.
            ground.visible_diffuse = ground.visible_shadow = False
            self._holds += _dim_and_fade(ground)
        self._facades = list(_dim_facades())
        if job.quality.clear_glass:
            self._open_glass()

    def hold(self, camera: Any, exposure_ev: float, rooms: Collection[str]) -> None:
        """Bring the view through the windows of rooms to what film can show at this exposure."""
        share = 1.0
        if self._light is not None:
            seen = self._luminance(camera, rooms) * 2.0**exposure_ev
            share = min(1.0, max(_LEAST, VIEW_WHITE / max(seen, 1e-9)))
        for value in self._holds:
            value.outputs[0].default_value = share
        for value in self._facades:
            # Seen through a window, or from where one sees the house.
            value.outputs[0].default_value = share if any(rooms) else 1.0

    def _open_glass(self) -> None:
        """Let light through panes as if they stood open, less what they would have kept."""
        clear = 1.0
        for pane in self._panes:
            pane.visible_shadow = pane.visible_diffuse = False
            clear = _clearness(pane)
        for lamp in bpy.data.lights:
            if lamp.type == "SUN":
                lamp.energy *= clear
        mix = next(n for n in self._world.node_tree.nodes if n.type == "MIX")
        mix.inputs["A"].default_value *= clear

    def show_ground(self, shown: bool) -> None:
        """To the camera."""
        for ground in self.grounds:
            ground.visible_camera = shown

    def _luminance(self, camera: Any, rooms: Collection[str]) -> float:
        """Of the brighter part of what a camera sees through windows: between what they show on
        the whole and what the brightest does."""
        light = self._light
        assert light is not None
        height, width = light.shape
        mapping = next(n for n in self._world.node_tree.nodes if n.type == "MAPPING")
        turn_deg = math.degrees(mapping.inputs["Rotation"].default_value[2])
        columns = (np.arange(width) + 0.5) / width * 360.0
        heights = 90.0 - (np.arange(height) + 0.5) / height * 180.0
        seen = []
        for yaw_deg, half_deg, low_deg, high_deg in self._views(camera, rooms):
            # Longitude 0 is the left edge; checked on a picture with three marks.
            middle_deg = 180.0 - turn_deg - yaw_deg
            near = np.abs((columns - middle_deg + 180.0) % 360.0 - 180.0) <= max(half_deg, 4.0)
            band = (heights >= low_deg) & (heights <= high_deg)
            seen.append(float(np.percentile(light[np.ix_(band, near)], _BRIGHTER)))
        return math.sqrt(max(seen) * float(np.mean(seen)))

    def _views(
        self, camera: Any, rooms: Collection[str]
    ) -> list[tuple[float, float, float, float]]:
        """Yaw, half of the width, least and most height in degrees, of each pane in the picture;
        of the picture itself where there is none."""
        eye, to_camera = camera.matrix_world.translation, camera.matrix_world.inverted()
        half_deg = math.degrees(camera.data.angle) / 2
        views = []
        for pane in self._panes:
            if not any(_is_below(pane, room) for room in rooms):
                continue
            corners = [pane.matrix_world @ _vector(*corner) for corner in pane.bound_box]
            ahead = [to_camera @ corner for corner in corners]
            aside = [math.degrees(math.atan2(abs(c.x), -c.z)) for c in ahead]
            if min(aside) > half_deg:
                continue
            rays = [corner - eye for corner in corners]
            rises = [math.degrees(math.atan2(r.z, math.hypot(r.x, r.y))) for r in rays]
            middle = sum(rays, _vector(0.0, 0.0, 0.0))
            yaw_deg = math.degrees(math.atan2(middle.y, middle.x))
            turns = [math.degrees(math.atan2(r.y, r.x)) - yaw_deg for r in rays]
            wide_deg = max(abs((turn + 180.0) % 360.0 - 180.0) for turn in turns)
            low, high = max(min(rises), _BAND_DEG[0]), min(max(rises), _BAND_DEG[1])
            if high - low > _LEAST_BAND_DEG:
                views.append((yaw_deg, min(wide_deg, half_deg), low, high))
        if not views:
            forward = camera.matrix_world.to_3x3() @ _vector(0.0, 0.0, -1.0)
            yaw_deg = math.degrees(math.atan2(forward.y, forward.x))
            views.append((yaw_deg, half_deg, *_USUAL_BAND_DEG))
        return views


def panes() -> Iterator[Any]:
    """The glass of windows and doors."""
    return (
        thing
        for thing in _meshes()
        if thing.name.startswith(GLASS) and _is_below(thing, "Architecture")
    )


def _clearness(pane: Any) -> float:
    """Share of light that passes both faces of a pane."""
    for slot in pane.material_slots:
        tree = slot.material.node_tree
        surface = tree and next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
        if surface:
            return float((1.0 - surface.inputs["Alpha"].default_value) ** 2)
    return 1.0


def _meshes() -> list[Any]:
    return [thing for thing in bpy.data.objects if thing.type == "MESH"]


def _is_below(thing: Any, name: str) -> bool:
    above = thing.parent
    while above is not None:
        if above.name.split(".")[0] == name:
            return True
        above = above.parent
    return False


def _vector(x: float, y: float, z: float) -> Any:
    from mathutils import Vector

    return Vector((x, y, z))


def _sky_light(world: Any) -> np.ndarray | None:
    """(H, W) luminance of the sky's picture, the top row first, made small; None without one."""
    nodes = world.node_tree.nodes
    sky = next((n.image for n in nodes if n.type == "TEX_ENVIRONMENT"), None)
    if sky is None or not sky.size[0] or not any(n.type == "MAPPING" for n in nodes):
        return None
    background = next(n for n in nodes if n.type == "BACKGROUND")
    rgba = np.empty(sky.size[0] * sky.size[1] * sky.channels, dtype=np.float32)
    sky.pixels.foreach_get(rgba)
    light = rgba.reshape(sky.size[1], sky.size[0], -1)[::-1, :, :3] @ (0.2126, 0.7152, 0.0722)
    if sky.colorspace_settings.name == "sRGB":
        light = light**2.2
    step = max(1, sky.size[0] // _SAMPLED_PX[0])
    small: np.ndarray = light[step // 2 :: step, step // 2 :: step]
    return small * float(background.inputs["Strength"].default_value)


def _dim_for_camera(world: Any) -> Any:
    """Let the camera and mirrors see the sky at a share of its strength; returns the node of the
    share."""
    tree = world.node_tree
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    share = tree.nodes.new("ShaderNodeValue")
    strength = tree.nodes.new("ShaderNodeMath")
    strength.operation = "MULTIPLY"
    strength.inputs[1].default_value = background.inputs["Strength"].default_value
    tree.links.new(_share_if_seen(tree, share), strength.inputs[0])
    tree.links.new(strength.outputs[0], background.inputs["Strength"])
    return share


def _share_if_seen(tree: Any, share: Any) -> Any:
    """A socket that gives the share to the camera and what mirrors show it, else one."""
    ray, mix = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMix")
    # The rays of a mirror are singular, since its roughness is zero.
    seen = tree.nodes.new("ShaderNodeMath")
    seen.operation = "MAXIMUM"
    tree.links.new(ray.outputs["Is Camera Ray"], seen.inputs[0])
    tree.links.new(ray.outputs["Is Singular Ray"], seen.inputs[1])
    tree.links.new(seen.outputs[0], mix.inputs["Factor"])
    mix.inputs["A"].default_value = 1.0
    tree.links.new(share.outputs[0], mix.inputs["B"])
    return mix.outputs["Result"]


def _dim_facades() -> Iterator[Any]:
    """Let the camera and mirrors see the house's own facades at a share of their brightness."""
    names = {
        slot.material.name
        for thing in _meshes()
        if _is_below(thing, FACADES)
        for slot in thing.material_slots
    }
    for name in sorted(names):
        tree = bpy.data.materials[name].node_tree
        surface = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
        if surface is None or surface.inputs["Base Color"].is_linked:
            continue
        share, dim = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("ShaderNodeVectorMath")
        dim.operation = "SCALE"
        dim.inputs[0].default_value = surface.inputs["Base Color"].default_value[:3]
        tree.links.new(_share_if_seen(tree, share), dim.inputs["Scale"])
        tree.links.new(dim.outputs[0], surface.inputs["Base Color"])
        yield share


def _dim_and_fade(ground: Any) -> Iterator[Any]:
    """The same for the ground, which far away gives way to the sky's own."""
    for slot in ground.material_slots:
        tree = slot.material.node_tree
        surface = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
        output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"), None)
        if surface is None or output is None or not surface.inputs["Base Color"].is_linked:
            continue
        colour = surface.inputs["Base Color"].links[0].from_socket
        share = tree.nodes.new("ShaderNodeValue")
        dim = tree.nodes.new("ShaderNodeVectorMath")
        dim.operation = "SCALE"
        matte = tree.nodes.new("ShaderNodeBsdfDiffuse")
        tree.links.new(colour, dim.inputs[0])
        tree.links.new(share.outputs[0], dim.inputs["Scale"])
        tree.links.new(dim.outputs[0], matte.inputs["Color"])
        far = tree.nodes.new("ShaderNodeMapRange")
        far.inputs["From Min"].default_value, far.inputs["From Max"].default_value = _FADES_M
        eye = tree.nodes.new("ShaderNodeCameraData")
        tree.links.new(eye.outputs["View Distance"], far.inputs["Value"])
        clear = tree.nodes.new("ShaderNodeBsdfTransparent")
        fade = tree.nodes.new("ShaderNodeMixShader")
        tree.links.new(far.outputs["Result"], fade.inputs[0])
        tree.links.new(matte.outputs[0], fade.inputs[1])
        tree.links.new(clear.outputs[0], fade.inputs[2])
        tree.links.new(fade.outputs[0], output.inputs["Surface"])
        yield share
