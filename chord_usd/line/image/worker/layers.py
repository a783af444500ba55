"""Light with its passes in one file: what compositors ask for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

PASSES = (
    "z", "normal", "diffuse_direct", "diffuse_indirect", "diffuse_color", "glossy_direct",
    "glossy_indirect", "glossy_color", "transmission_direct", "transmission_indirect",
    "transmission_color", "emit", "environment", "cryptomatte_object", "cryptomatte_material",
    "cryptomatte_asset",
)  # fmt: skip
"""Without motion vectors: views are stills, and Cycles crashes (signal 11) where a scene that it
keeps from one render to the next gets this pass in between."""


def ask_for_layers(scene: Any, path: Path) -> None:
    """Let the next render of a scene write all of them, and what a denoiser is guided by."""
    layer = scene.view_layers[0]
    for name in PASSES:
        setattr(layer, f"use_pass_{name}", True)
    layer.cycles.denoising_store_passes = True
    write_layers(scene)
    scene.render.filepath = str(path)


def write_layers(scene: Any) -> None:
    """Let a scene write all its passes, 32 bits each, as layers of one EXR."""
    picture = scene.render.image_settings
    picture.media_type, picture.file_format = "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER"
    picture.color_depth, picture.exr_codec = "32", "ZIP"
    # Else each pass becomes a part of the file of its own, which many readers miss.
    picture.use_exr_interleave = True
